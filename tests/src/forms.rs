//! Multipart forms, as sent by a browser or curl.

use serde_json::Value;

use crate::{Service, agent};

impl Service {
    /// POST of a form with these fields.
    ///
    /// # Panics
    /// If the service does not respond.
    #[must_use]
    pub fn form(&self, path: &str, fields: &[(&str, &[u8])]) -> (u16, Value) {
        const BOUNDARY: &str = "----fathom-test-boundary";
        let mut form = Vec::new();
        for (name, bytes) in fields {
            let head = format!("--{BOUNDARY}\r\nContent-Disposition: form-data; name=\"{name}\"\r\n\r\n");
            form.extend([head.as_bytes(), bytes, b"\r\n"].concat());
        }
        form.extend_from_slice(format!("--{BOUNDARY}--\r\n").as_bytes());
        let mut response = agent()
            .post(format!("{}{path}", self.url))
            .header(
                "content-type",
                format!("multipart/form-data; boundary={BOUNDARY}"),
            )
            .send(&form)
            .expect("the service responds");
        let bytes = response.body_mut().read_to_vec().expect("a complete response");
        (
            response.status().as_u16(),
            serde_json::from_slice(&bytes).unwrap_or_default(),
        )
    }
}
