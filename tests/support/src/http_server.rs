//! Servers of a few lines that say what a test wants them to.

#![allow(clippy::unwrap_used)]

use std::io::{self, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{self, Receiver};
use std::thread;

/// Serves connections in a thread, one after another. Returns the port.
pub fn serve(mut each: impl FnMut(TcpStream) + Send + 'static) -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    thread::spawn(move || listener.incoming().for_each(|stream| each(stream.unwrap())));
    port
}

/// Serves these answers, one a connection. Returns the port and the requests, each known before its answer is.
pub fn serve_answers(answers: Vec<String>) -> (u16, Receiver<String>) {
    let (sender, requests) = mpsc::channel();
    let mut answers = answers.into_iter();
    let port = serve(move |mut stream| {
        let Some(answer) = answers.next() else { return };
        // Who connects and says nothing hears nothing.
        let Ok(request) = request_of(&mut stream) else { return };
        let _ = sender.send(request);
        let _ = stream.write_all(answer.as_bytes());
    });
    (port, requests)
}

/// An answer after which the connection ends.
pub fn answer(status: &str, body: &str) -> String {
    let length = body.len();
    format!("HTTP/1.1 {status}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}")
}

/// Reads a request with its body.
pub fn request_of(stream: &mut impl Read) -> io::Result<String> {
    let mut read = Vec::new();
    while !read.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        stream.read_exact(&mut byte)?;
        read.push(byte[0]);
    }
    let head = String::from_utf8(read).unwrap();
    let mut lengths = head.lines().filter_map(|line| {
        let (name, value) = line.split_once(':')?;
        name.eq_ignore_ascii_case("content-length").then(|| value.trim().parse::<usize>().unwrap())
    });
    let mut body = vec![0; lengths.next_back().unwrap_or(0)];
    stream.read_exact(&mut body)?;
    // Packed bytes are no text; what is a text stays as it is.
    Ok(head + &String::from_utf8_lossy(&body))
}
