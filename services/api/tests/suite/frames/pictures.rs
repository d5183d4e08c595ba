//! User images: enhanced and measured, never stored.

use crate::common::bytes::{png, png_head};
use crate::common::start;
use crate::rejections::bad_input::nothing_changes;
use imaging::codec::decode_picture;
use serde_json::json;

#[test]
fn an_enhanced_image_equals_that_of_the_library() {
    let service = start();
    let sent = png(61, 47);
    let picture = decode_picture(&sent).unwrap();
    for method in enhance::METHODS {
        let answer = service.form(&format!("/v1/enhance?method={method}"), &[("picture", &sent)]);
        assert_eq!(
            (answer.status, answer.header("content-type")),
            (200, "image/png"),
            "{}",
            answer.text()
        );
        let method = enhance::Method::parse(method).unwrap();
        let expected = enhance::run(&method, &picture).unwrap();
        assert_eq!(
            decode_picture(&answer.body).unwrap().to_rgb8(),
            expected.picture.to_rgb8()
        );
        let codes: Vec<_> = expected.warnings.iter().map(|warning| warning.code()).collect();
        assert_eq!(answer.header("fathom-warnings"), codes.join(", "));
    }
    let masked = service.form(
        "/v1/enhance?method=hscm:cutoff=16,mask=paper&format=webp",
        &[("picture", &sent)],
    );
    assert_eq!(masked.header("content-type"), "image/webp", "{}", masked.text());
    let hscm = spec::Enhancement::parse("hscm:cutoff=16,mask=paper").unwrap();
    let expected = enhance::enhance(&hscm, &picture, &[], &mut enhance::refuse_network).unwrap();
    assert_ne!(expected.picture, expected.unmasked);
    assert_eq!(
        decode_picture(&masked.body).unwrap().to_rgb8(),
        expected.picture.to_rgb8()
    );
    let wrong = service.form("/v1/enhance?method=hscm:cutoff=0,cut=1", &[("picture", &sent)]);
    let pointers = wrong.json()["errors"].as_array().unwrap().len();
    assert_eq!((wrong.status, pointers), (422, 2), "{}", wrong.text());
    assert_eq!(service.shown(), [0, 0, 0]);
}

#[test]
fn metrics_are_those_of_the_library() {
    let service = start();
    let sent = png(61, 47);
    let picture = decode_picture(&sent).unwrap().to_rgb8();
    let measured = service.form("/v1/measure", &[("picture", &sent)]).json();
    assert_eq!(
        (&measured["width"], &measured["height"]),
        (&json!(61), &json!(47)),
        "{measured}"
    );
    let names = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"];
    assert_eq!(measured["metrics"].as_object().unwrap().len(), names.len());
    let ids: Vec<_> = names.map(|name| quality::MetricId::parse(name).unwrap()).to_vec();
    for (id, value) in quality::measure(&picture, None, &ids).unwrap() {
        assert_eq!(measured["metrics"][id.to_string()], json!(value), "{id}");
    }
    let fields: [(&str, &[u8]); 2] = [("picture", &sent), ("clean", &sent)];
    let compared = service
        .form("/v1/measure?metrics=ssim,uiqm@table1", &fields)
        .json();
    assert_eq!(compared["metrics"]["ssim"], json!(1.0), "{compared}");
}

/// Path, form fields, pointer of the error, part of its message.
type Refused<'a> = (&'a str, Vec<(&'a str, &'a [u8])>, &'a str, &'a str);

#[test]
fn bad_images_are_rejected_with_the_field_and_nothing_is_stored() {
    let (good, other, bomb) = (png(20, 10), png(10, 20), png_head(60_000, 60_000));
    let large = png(4001, 4000);
    let cases: Vec<Refused> = vec![
        (
            "enhance?method=magic",
            vec![("picture", &good)],
            "/method",
            "magic",
        ),
        (
            "enhance?method=hscm",
            vec![("picture", &bomb)],
            "/picture",
            "60000",
        ),
        (
            "enhance?method=hscm",
            vec![("picture", &large)],
            "/picture",
            "16004000 pixels; must be at most 16000000",
        ),
        (
            "enhance?method=hscm",
            vec![("picture", &good[..30])],
            "/picture",
            "damaged",
        ),
        (
            "enhance?method=hscm",
            vec![("picture", b"text")],
            "/picture",
            "neither PNG nor JPEG",
        ),
        ("enhance?method=hscm", vec![], "/picture", "missing"),
        (
            "enhance?method=hscm",
            vec![("clean", &good)],
            "/clean",
            "must be one of picture",
        ),
        (
            "enhance?method=hscm",
            vec![("picture", &good), ("picture", &good)],
            "/picture",
            "twice",
        ),
        (
            "measure?metrics=uiqn",
            vec![("picture", &good)],
            "/metrics",
            "uiqn",
        ),
        (
            "measure?metrics=",
            vec![("picture", &good)],
            "/metrics",
            "does not exist",
        ),
        (
            "measure?metrics=psnr",
            vec![("picture", &good)],
            "/clean",
            "missing",
        ),
        (
            "measure?metrics=psnr",
            vec![("picture", &good), ("clean", &other)],
            "/clean",
            "20×10",
        ),
    ];
    nothing_changes(|service| {
        for (path, fields, pointer, fragment) in cases {
            let problem = service
                .form(&format!("/v1/{path}"), &fields)
                .problem(422, "validation");
            let error = &problem["errors"][0];
            assert_eq!(error["pointer"], pointer, "{path}: {problem}");
            assert!(
                error["message"].as_str().unwrap().contains(fragment),
                "{path}: {problem}"
            );
        }
        service
            .form("/v1/enhance", &[("picture", &good)])
            .problem(400, "invalid-query");
        service
            .form("/v1/enhance?method=hscm&format=bmp", &[("picture", &good)])
            .problem(400, "invalid-query");
        service
            .post_with("/v1/enhance?method=hscm", &[("content-type", "image/png")], &good)
            .problem(415, "unsupported-media-type");
    });
}

#[test]
fn a_form_of_many_fields_is_refused_at_its_beginning() {
    let many: Vec<(&str, &[u8])> = vec![("nonsense", b"x"); 100];
    nothing_changes(|service| {
        let problem = service.upload(&many).problem(400, "invalid-body");
        assert!(
            problem["detail"].as_str().unwrap().contains("32 fields"),
            "{problem}"
        );
        service.form("/v1/measure", &many).problem(400, "invalid-body");
    });
}
