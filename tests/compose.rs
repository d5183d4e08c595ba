//! docker-compose.yml and the Dockerfile agree with the options that the binary has.

use std::collections::BTreeSet;
use std::fs;

use fathom_tests::{root, run};
use serde_yaml_ng::Value;

fn compose() -> Value {
    let text = fs::read_to_string(root().join("docker-compose.yml")).expect("docker-compose.yml is there");
    let mut compose: Value = serde_yaml_ng::from_str(&text).expect("docker-compose.yml is YAML");
    compose.apply_merge().expect("its merge keys name mappings");
    compose
}

fn help(command: &str) -> String {
    let output = run(&[command, "--help"]);
    assert!(output.status.success(), "fathom {command} --help: {output:?}");
    String::from_utf8(output.stdout).expect("help is text")
}

fn strings(value: &Value) -> Vec<String> {
    value
        .as_sequence()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .map(str::to_owned)
        .collect()
}

#[test]
fn there_is_one_service_and_two_separate_workers() {
    let compose = compose();
    let services = compose["services"].as_mapping().expect("services");
    let commands: Vec<String> = services
        .values()
        .map(|service| strings(&service["command"]).first().cloned().unwrap_or_default())
        .collect();
    assert_eq!(
        commands.iter().filter(|command| *command == "serve").count(),
        1,
        "{commands:?}"
    );
    assert_eq!(
        commands.iter().filter(|command| *command == "worker").count(),
        2,
        "{commands:?}"
    );
}

#[test]
fn every_option_and_variable_in_the_compose_file_exists_in_the_binary() {
    let compose = compose();
    for (name, service) in compose["services"].as_mapping().expect("services") {
        let command = strings(&service["command"]);
        let help = help(&command[0]);
        for option in command.iter().filter(|word| word.starts_with("--")) {
            let option = option.split('=').next().unwrap_or(option);
            assert!(
                help.contains(&format!("{option} ")),
                "{name:?}: fathom {} has no {option}",
                command[0]
            );
        }
        let variables = service["environment"]
            .as_mapping()
            .expect("a mapping of variables");
        for variable in variables.keys().filter_map(Value::as_str) {
            let known = help.contains(&format!("[env: {variable}"))
                || ["FATHOM_LOG", "FATHOM_LOG_FORMAT"].contains(&variable);
            assert!(known, "{name:?}: fathom {} does not read {variable}", command[0]);
        }
    }
}

#[test]
fn workers_speak_to_the_service_by_its_name_and_port() {
    let compose = compose();
    let services = compose["services"].as_mapping().expect("services");
    let names: BTreeSet<&str> = services.keys().filter_map(Value::as_str).collect();
    for service in services
        .values()
        .filter(|service| strings(&service["command"])[0] == "worker")
    {
        let url = service["environment"]["FATHOM_SERVER"]
            .as_str()
            .expect("workers are told their server");
        let host = url
            .trim_start_matches("http://")
            .split(':')
            .next()
            .unwrap_or_default();
        assert!(names.contains(host), "{host} is no service of the file");
        let port = url.rsplit(':').next().unwrap_or_default();
        let listen = services[host]["environment"]["FATHOM_LISTEN"]
            .as_str()
            .expect("the service is told its port");
        assert!(
            listen.ends_with(&format!(":{port}")),
            "{url} does not match {listen}"
        );
        assert!(
            service["depends_on"][host].is_mapping(),
            "workers wait for the service"
        );
    }
}

#[test]
fn the_dockerfile_installs_the_runtime_and_starts_the_binary() {
    let text = fs::read_to_string(root().join("Dockerfile")).expect("a Dockerfile");
    assert!(text.contains("scripts/get-onnxruntime.sh"));
    assert!(
        text.lines()
            .any(|line| line.starts_with("ENTRYPOINT") && line.contains("fathom"))
    );
    for path in text
        .lines()
        .filter(|line| line.starts_with("COPY ") && !line.contains("--from"))
    {
        for source in path
            .split_whitespace()
            .skip(1)
            .take_while(|word| !word.starts_with('/') && *word != "./")
        {
            assert!(
                root().join(source).exists(),
                "the Dockerfile copies {source}, which is not there"
            );
        }
    }
}
