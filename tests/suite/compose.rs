//! docker-compose.yml and the Dockerfile agree with the options of the binary.

use std::collections::BTreeSet;
use std::fs;

use fathom_tests::{root, run};
use serde_yaml_ng::Value;

/// Environment variables of a set in a bucket, as listed in docs/reference/sharded-datasets.md.
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

/// The services of a profile whose command starts with `word`; for `None`, those without a profile.
fn with_command<'a>(compose: &'a Value, profile: Option<&str>, word: &str) -> Vec<&'a Value> {
    let services = compose["services"].as_mapping().expect("services");
    services
        .values()
        .filter(|service| {
            let profiles = strings(&service["profiles"]);
            let is_in = profile.map_or(profiles.is_empty(), |name| {
                profiles.iter().any(|found| found == name)
            });
            is_in
                && strings(&service["command"])
                    .first()
                    .is_some_and(|first| first == word)
        })
        .collect()
}

/// The only service of a profile with this command.
fn only<'a>(compose: &'a Value, profile: Option<&str>, word: &str) -> &'a Value {
    let [service] = with_command(compose, profile, word)[..] else {
        panic!("one service of {profile:?} has the command {word}");
    };
    service
}

fn option(service: &Value, name: &str) -> String {
    let words = strings(&service["command"]);
    let position = words
        .iter()
        .position(|word| word == name)
        .expect("the option is given");
    words[position + 1].clone()
}

const SCALED: [&str; 3] = ["container_name", "ports", "hostname"];

#[test]
fn one_service_and_one_kind_of_worker_that_can_be_scaled() {
    let compose = compose();
    for profile in [None, Some("cluster")] {
        only(&compose, profile, "serve");
        let worker = only(&compose, profile, "worker");
        for unique in SCALED {
            assert!(worker[unique].is_null(), "{unique} allows only one worker");
        }
        assert!(
            worker["environment"]["FATHOM_WORKER_NAME"].is_null(),
            "scaled workers would share a name"
        );
        assert!(worker["scale"].as_u64() >= Some(2));
    }
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
    for profile in [None, Some("cluster")] {
        for command in ["serve", "worker"] {
            let service = only(&compose, profile, command);
            assert_eq!(service["image"], built["image"]);
            assert_eq!(service["restart"].as_str(), Some("unless-stopped"));
        }
    }
}

#[test]
fn workers_hold_a_secret_that_opens_the_worker_protocol_alone() {
    let compose = compose();
    let serve = only(&compose, None, "serve");
    let tokens = serve["environment"]["FATHOM_TOKEN"].as_str().expect("tokens");
    for worker in with_command(&compose, None, "worker") {
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
            let has_store = command.iter().any(|word| word.starts_with("s3://"));
            let is_for_the_store = STORE_VARIABLES.contains(&variable) && has_store;
            let known = help.contains(&format!("[env: {variable}"))
                || ["FATHOM_LOG", "FATHOM_LOG_FORMAT"].contains(&variable)
                || is_for_the_store;
            assert!(known, "{name}: fathom {} does not read {variable}", command[0]);
        }
    }
}

#[test]
fn every_command_in_the_compose_file_is_one_that_the_binary_takes() {
    let compose = compose();
    let takes = |words: &[String]| {
        // Everything before `--help` is parsed without starting anything.
        let words: Vec<&str> = words.iter().map(String::as_str).chain(["--help"]).collect();
        run(&words).status.success()
    };
    for (name, service) in ours(&compose) {
        let command = strings(&service["command"]);
        assert!(takes(&command), "{name}: fathom {command:?}");
        let mut wrong = command.clone();
        wrong.push("--no-such-option=x".to_owned());
        assert!(!takes(&wrong), "{name}: anything is taken");
    }
}

#[test]
fn the_cluster_has_one_store_one_broker_and_one_secret_for_it() {
    let compose = compose();
    let (serve, worker) = (
        only(&compose, Some("cluster"), "serve"),
        only(&compose, Some("cluster"), "worker"),
    );
    for place in ["--engine", "--store"] {
        assert_eq!(option(serve, place), option(worker, place), "{place}");
    }
    for variable in STORE_VARIABLES.into_iter().chain(["FATHOM_ENGINE_TOKEN"]) {
        let value = |service: &Value| service["environment"][variable].clone();
        assert!(value(serve).is_string(), "{variable} is not set");
        assert_eq!(value(serve), value(worker), "{variable}");
    }
    let engine = option(serve, "--engine");
    let (host, port) = engine
        .trim_start_matches("nats://")
        .split_once(':')
        .expect("a port");
    let broker = &compose["services"][host];
    assert!(
        broker["image"]
            .as_str()
            .is_some_and(|image| image.starts_with("nats:2.")),
        "{broker:?}"
    );
    let config = compose["configs"]["broker"]["content"]
        .as_str()
        .expect("a configuration");
    let token = serve["environment"]["FATHOM_ENGINE_TOKEN"]
        .as_str()
        .expect("a token");
    for part in [
        &format!("listen: 0.0.0.0:{port}"),
        "sync_interval: always",
        &format!("token: \"{token}\""),
    ] {
        assert!(config.contains(part), "{part} is not in {config}");
    }
    assert_eq!(broker["configs"][0]["source"].as_str(), Some("broker"));
    assert_eq!(
        strings(&broker["command"])[1],
        broker["configs"][0]["target"].as_str().expect("a place")
    );
    let store = option(serve, "--store");
    let bucket = store
        .trim_start_matches("s3://")
        .split('/')
        .next()
        .unwrap_or_default();
    let created = strings(&compose["services"]["bucket"]["entrypoint"]).join(" ");
    assert!(
        created.contains(&format!("s3.bucket.create -name {bucket}'")),
        "{created}"
    );
    for service in [serve, worker] {
        for awaited in [host, "bucket"] {
            assert!(
                service["depends_on"][awaited].is_mapping(),
                "{awaited} is waited for"
            );
        }
    }
    for name in [host, "store", "bucket"] {
        let profiles = strings(&compose["services"][name]["profiles"]);
        assert!(
            profiles.contains(&"cluster".to_owned()),
            "{name} is not in the profile"
        );
    }
    let published = |service: &Value| strings(&service["ports"]);
    assert_ne!(
        published(serve),
        published(only(&compose, None, "serve")),
        "both may run"
    );
}

#[test]
fn workers_speak_to_the_service_by_its_name_and_port() {
    let compose = compose();
    let services = compose["services"].as_mapping().expect("services");
    let names: BTreeSet<&str> = services.keys().filter_map(Value::as_str).collect();
    for service in with_command(&compose, None, "worker") {
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
    let shards = only(&compose, Some("set"), "render");
    let store = &compose["services"]["store"];
    for service in [store, &compose["services"]["bucket"]] {
        assert!(strings(&service["profiles"]).contains(&"set".to_owned()));
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
    for unique in SCALED {
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
    assert!(text.contains("--bin fathom\n") && text.contains("/src/target/release/fathom "));
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
