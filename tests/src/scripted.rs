//! A fake service with scripted responses.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;

/// Status and body of a response.
pub type Reply = (u16, Vec<u8>);

/// Serves `reply` of the path and query of each request until the process ends; returns the URL.
///
/// # Panics
/// If there is no free port.
pub fn serve(reply: impl Fn(&str) -> Reply + Send + Sync + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let url = format!("http://{}", listener.local_addr().expect("an address"));
    let reply = Arc::new(reply);
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let reply = Arc::clone(&reply);
            std::thread::spawn(move || while respond(&stream, &*reply).is_some() {});
        }
    });
    url
}

fn respond(mut stream: &TcpStream, reply: &dyn Fn(&str) -> Reply) -> Option<()> {
    let mut lines = BufReader::new(stream).lines();
    let path = lines.next()?.ok()?.split(' ').nth(1)?.to_owned();
    lines
        .find(|line| line.as_ref().is_ok_and(String::is_empty))?
        .ok()?;
    let (status, body) = reply(&path);
    let head = format!("HTTP/1.1 {status} \r\ncontent-length: {}\r\n\r\n", body.len());
    stream.write_all(head.as_bytes()).ok()?;
    stream.write_all(&body).ok()
}
