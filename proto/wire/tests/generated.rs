//! `src/messages.rs` matches the protocol file. It is committed so that a build needs no protobuf compiler. Update it
//! with `FATHOM_WRITE=1 cargo test -p wire`.

use std::path::Path;

#[test]
fn the_generated_messages_are_those_of_the_protocol_file() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = protox::compile(["fathom/worker/v1.proto"], [folder]).expect("a well-formed protocol");
    let out = tempfile::tempdir().expect("a temporary folder");
    prost_build::Config::new()
        .btree_map(["."])
        .out_dir(out.path())
        .compile_fds(files)
        .expect("generated messages");
    let generated =
        std::fs::read_to_string(out.path().join("fathom.worker.v1.rs")).expect("a generated file");
    let kept = folder.join("src/messages.rs");
    if std::env::var_os("FATHOM_WRITE").is_some() {
        std::fs::write(&kept, &generated).expect("a writable source folder");
    }
    let kept = std::fs::read_to_string(kept).expect("src/messages.rs");
    assert!(
        kept == generated,
        "src/messages.rs is not what the protocol file says; see the head of this test"
    );
}
