//! A job's description: refused or valid; a valid one resolves, and its canonical text means the same.
#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use spec::{Job, Vocabulary};

static VOCABULARY: LazyLock<Vocabulary> = LazyLock::new(|| {
    let library = style::Library::embedded().expect("the models of this build");
    renderer::vocabulary(&library, false)
});

fuzz_target!(|json: &[u8]| {
    let Ok(job) = Job::parse(json, &VOCABULARY) else {
        return;
    };
    let last = job.frames() - 1;
    for index in [0, last / 2, last] {
        // Laws may meet in a combination that no frame can have; that is an error of the frame, told with its field.
        let _ = job.resolve(index);
    }
    let again = Job::parse(job.canonical().as_bytes(), &VOCABULARY).expect("canonical text is valid");
    assert_eq!(again.canonical(), job.canonical());
    assert_eq!(again.digest(), job.digest());
});
