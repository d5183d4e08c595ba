//! `fathom verify`: computes the root of a sealed version again.

use cli::exit::Failure;
use cli::known::{self, Version};
use cli::seal::{VerifyArguments, is_set};
use client::{DamagedImage, VerifiedVersion};
use serde_json::json;

use crate::commands::sharded;

/// Runs the command.
pub(crate) fn run(arguments: &VerifyArguments) -> Result<(), Failure> {
    let name = &arguments.what;
    if is_set(name) {
        return sharded::verify::run(arguments);
    }
    let Some(Version { dataset, number }) = known::version(name) else {
        return Err(Failure::BadInput(format!(
            "`{name}` is not a sealed version such as {name}@1, which `fathom datasets {name}` lists; a set is written with a \
             slash, such as ./{name}"
        )));
    };
    let client = arguments.server.patient_client();
    let found = client.verify(dataset, number, arguments.bytes)?;
    if arguments.json {
        println!("{}", json!(found));
    } else {
        show(name, &found, arguments.bytes);
    }
    match found.intact {
        true => Ok(()),
        false => Err(anyhow::anyhow!(
            "{name} has changed since it was sealed: {} findings",
            found.damages
        )
        .into()),
    }
}

fn show(name: &str, found: &VerifiedVersion, has_read_bytes: bool) {
    for DamagedImage { job, frame, reason } in &found.damaged {
        let frame = frame.map_or_else(String::new, |frame| format!("/{frame}"));
        println!("{job}{frame}: {reason}");
    }
    let artifacts = match has_read_bytes {
        true => format!(" and the bytes of {} artifacts", found.artifacts),
        false => String::new(),
    };
    println!("{name}: {} records{artifacts} read", found.images);
    println!("sealed root   {}", found.root);
    println!("computed root {}", found.computed);
}
