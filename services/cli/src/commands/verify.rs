//! `fathom verify`: computes the root of a sealed version again; of a set this command becomes `fathom-cluster`.

use cli::exit::Failure;
use cli::known::{self, Version};
use cli::remote::{Remote, encode};
use cli::seal::{VerifyArguments, is_set};
use cli::table::cell;
use serde_json::{Value, json};

use super::cluster;

/// Runs the command.
pub(crate) fn run(arguments: &VerifyArguments) -> Result<(), Failure> {
    let name = &arguments.what;
    if is_set(name) {
        return cluster::hand_over();
    }
    let Some(Version { dataset, number }) = known::version(name) else {
        return Err(Failure::BadInput(format!(
            "`{name}` is no sealed version, such as {name}@1, of which `fathom datasets {name}` lists those there are; a set is \
             written with a slash, such as ./{name}"
        )));
    };
    let remote = Remote::with_patience(&arguments.server);
    let path = format!("/v1/datasets/{}/versions/{number}/verify", encode(dataset));
    let wish = json!({"bytes": arguments.bytes}).to_string();
    let found = remote.post(&path, &[], wish.as_bytes())?;
    if arguments.json {
        println!("{found}");
    } else {
        show(name, &found, arguments.bytes);
    }
    match found["intact"] == true {
        true => Ok(()),
        false => Err(anyhow::anyhow!(
            "{name} is not what was sealed: {} findings",
            cell(&found["damages"])
        )
        .into()),
    }
}

fn show(name: &str, found: &Value, has_read_bytes: bool) {
    for damaged in found["damaged"].as_array().into_iter().flatten() {
        let frame = damaged["frame"]
            .as_u64()
            .map_or_else(String::new, |frame| format!("/{frame}"));
        println!("{}{frame}: {}", cell(&damaged["job"]), cell(&damaged["reason"]));
    }
    let artifacts = match has_read_bytes {
        true => format!(" and the bytes of {} artifacts", cell(&found["artifacts"])),
        false => String::new(),
    };
    println!("{name}: {} records{artifacts} read", cell(&found["images"]));
    println!("sealed root   {}", cell(&found["root"]));
    println!("computed root {}", cell(&found["computed"]));
}
