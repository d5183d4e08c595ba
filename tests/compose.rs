//! docker-compose.yml and the Dockerfile agree with the options that the binary has.

use std::collections::BTreeSet;
use std::fs;

use fathom_tests::{root, run};
use serde_yaml_ng::Value;

/// What a set in a bucket is reached by, as docs/cluster.md lists it.
const STORE_VARIABLES: [&str; 4] = [
    "AWS_ENDPOINT_URL",
    "AWS_REGION",
    "AWS_ACCESS_KEY_ID",
    "AWS_SECRET_ACCESS_KEY",
];

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

/// Services that run our image, by name; the others are S3 servers.
fn ours(compose: &Value) -> Vec<(&str, &Value)> {
    let services = compose["services"].as_mapping().expect("services");
    services
        .iter()
        .filter(|(_, service)| service["image"].as_str() == Some("fathom"))
        .map(|(name, service)| (name.as_str().expect("a name"), service))
        .collect()
}

/// The services of the file whose command starts with `word`.
fn with_command<'a>(compose: &'a Value, word: &str) -> Vec<&'a Value> {
    let services = compose["services"].as_mapping().expect("services");
    services
        .values()
        .filter(|service| {
            strings(&service["command"])
                .first()
                .is_some_and(|first| first == word)
        })
        .collect()
}

#[test]
fn one_service_and_one_kind_of_worker_that_can_be_scaled() {
    let compose = compose();
    assert_eq!(with_command(&compose, "serve").len(), 1);
    let [worker] = with_command(&compose, "worker")[..] else {
        panic!("one worker, to be scaled");
    };
    for unique in ["container_name", "ports", "hostname"] {
        assert!(worker[unique].is_null(), "{unique} allows only one worker");
    }
    assert!(
        worker["environment"]["FATHOM_WORKER_NAME"].is_null(),
        "scaled workers would share a name"
    );
    assert!(worker["scale"].as_u64() >= Some(2));
}

#[test]
fn one_image_is_built_once_and_everything_comes_back_after_a_restart() {
    let compose = compose();
    let services = compose["services"].as_mapping().expect("services");
    let built: Vec<&Value> = services
        .values()
        .filter(|service| !service["build"].is_null())
        .collect();
    let [built] = built[..] else {
        panic!("one service builds the image");
    };
    for service in with_command(&compose, "serve")
        .into_iter()
        .chain(with_command(&compose, "worker"))
    {
        assert_eq!(service["image"], built["image"]);
        assert_eq!(service["restart"].as_str(), Some("unless-stopped"));
    }
}

#[test]
fn workers_hold_a_secret_that_opens_the_worker_protocol_alone() {
    let compose = compose();
    let serve = with_command(&compose, "serve")[0];
    let tokens = serve["environment"]["FATHOM_TOKEN"].as_str().expect("tokens");
    for worker in with_command(&compose, "worker") {
        let secret = worker["environment"]["FATHOM_TOKEN"].as_str().expect("a token");
        assert!(
            tokens.contains(&format!("work:{secret}")),
            "{tokens} has no work:{secret}"
        );
        assert!(!tokens.contains(&format!("admin:{secret}")));
    }
}

#[test]
fn every_option_and_variable_in_the_compose_file_exists_in_the_binary() {
    let compose = compose();
    for (name, service) in ours(&compose) {
        let command = strings(&service["command"]);
        let help = help(&command[0]);
        for option in command.iter().filter(|word| word.starts_with("--")) {
            let option = option.split('=').next().unwrap_or(option);
            assert!(
                help.contains(&format!("{option} ")),
                "{name}: fathom {} has no {option}",
                command[0]
            );
        }
        let variables = service["environment"]
            .as_mapping()
            .expect("a mapping of variables");
        for variable in variables.keys().filter_map(Value::as_str) {
            let is_for_the_store = STORE_VARIABLES.contains(&variable) && command[0] == "render";
            let known = help.contains(&format!("[env: {variable}"))
                || ["FATHOM_LOG", "FATHOM_LOG_FORMAT"].contains(&variable)
                || is_for_the_store;
            assert!(known, "{name}: fathom {} does not read {variable}", command[0]);
        }
    }
}

#[test]
fn workers_speak_to_the_service_by_its_name_and_port() {
    let compose = compose();
    let services = compose["services"].as_mapping().expect("services");
    let names: BTreeSet<&str> = services.keys().filter_map(Value::as_str).collect();
    for service in with_command(&compose, "worker") {
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
fn shards_are_rendered_into_the_bucket_of_the_store_by_processes_that_scale() {
    let compose = compose();
    let [shards] = with_command(&compose, "render")[..] else {
        panic!("one kind of process renders sets");
    };
    let store = &compose["services"]["store"];
    for service in [shards, store, &compose["services"]["bucket"]] {
        assert_eq!(strings(&service["profiles"]), ["cluster"]);
    }
    for variable in STORE_VARIABLES {
        assert!(
            shards["environment"][variable].is_string(),
            "{variable} is not set"
        );
    }
    for secret in ["AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"] {
        assert_eq!(shards["environment"][secret], store["environment"][secret]);
    }
    assert_eq!(
        shards["environment"]["AWS_ENDPOINT_URL"].as_str(),
        Some("http://store:8333")
    );
    let created = strings(&compose["services"]["bucket"]["entrypoint"]).join(" ");
    let out = strings(&shards["command"]);
    let bucket = out
        .iter()
        .find_map(|word| word.strip_prefix("s3://")?.split('/').next());
    let bucket = bucket.expect("a bucket");
    assert!(
        created.contains(&format!("s3.bucket.create -name {bucket}'")),
        "{created}"
    );
    for unique in ["container_name", "ports", "hostname"] {
        assert!(shards[unique].is_null(), "{unique} allows only one process");
    }
    let image = store["image"].as_str().expect("an image");
    assert!(
        image
            .split_once(':')
            .is_some_and(|(_, version)| version != "latest"),
        "{image} is not pinned"
    );
}

#[test]
fn the_dockerfile_installs_the_runtime_and_starts_the_binary() {
    let text = fs::read_to_string(root().join("Dockerfile")).expect("a Dockerfile");
    assert!(text.contains("scripts/get-onnxruntime.sh"));
    for binary in ["fathom", "fathom-cluster"] {
        assert!(text.contains(&format!("--bin {binary}")), "{binary} is not built");
        assert!(
            text.contains(&format!("/src/target/release/{binary} ")),
            "{binary} is not in the image"
        );
    }
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

#[test]
fn the_builder_is_sent_what_the_dockerfile_copies_and_no_more() {
    let ignore = fs::read_to_string(root().join(".dockerignore")).expect("a .dockerignore");
    let sent: BTreeSet<&str> = ignore.lines().filter_map(|line| line.strip_prefix('!')).collect();
    assert!(
        ignore.lines().any(|line| line == "*"),
        "everything else is left out"
    );
    let text = fs::read_to_string(root().join("Dockerfile")).expect("a Dockerfile");
    let copied: BTreeSet<&str> = text
        .lines()
        .filter(|line| line.starts_with("COPY ") && !line.contains("--from"))
        .flat_map(|line| {
            let mut words: Vec<&str> = line.split_whitespace().skip(1).collect();
            words.pop();
            words
        })
        .collect();
    assert_eq!(sent, copied);
}
