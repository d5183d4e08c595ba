//! Compiles the protocol to Rust without an installed protoc.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo:rerun-if-changed=fathom/worker/v1.proto");
    let files = protox::compile(["fathom/worker/v1.proto"], ["."])?;
    prost_build::Config::new().btree_map(["."]).compile_fds(files)?;
    Ok(())
}
