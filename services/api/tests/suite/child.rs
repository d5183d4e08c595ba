//! Program for a service under test in place of `fathom`: it decodes, renders pictures, accepts jobs of a store without rendering them, and fails
//! at everything else.

use std::io;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use api::{Accepted, Order};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["child", "decode", "--folder", folder, ..] => match api::decode_folder(Path::new(folder)) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("{error}");
                ExitCode::FAILURE
            }
        },
        ["child", "pictures", ..] => {
            let library = style::Library::embedded().expect("the shipped styles");
            let engine = Arc::new(renderer::Engine::new(library, None));
            match api::render_pictures(&engine, io::stdin().lock(), io::stdout().lock()) {
                Ok(()) => ExitCode::SUCCESS,
                Err(_) => ExitCode::FAILURE,
            }
        }
        ["child", "jobs", "submit", store] => {
            let order: Order = serde_json::from_reader(io::stdin()).expect("an order");
            let location = format!("{store}/{}", order.id);
            let accepted = Accepted::Job {
                id: order.id,
                location,
            };
            println!("{}", serde_json::to_string(&accepted).expect("JSON"));
            ExitCode::SUCCESS
        }
        ["child", "jobs", "state", _] => ExitCode::SUCCESS,
        ["child", "jobs", "watch", ..] => {
            // Until the service ends.
            let ended = io::copy(&mut io::stdin(), &mut io::sink());
            ended.map_or(ExitCode::FAILURE, |_| ExitCode::SUCCESS)
        }
        _ => ExitCode::FAILURE,
    }
}
