//! A browser's side of HTTP, without a browser's manners.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::time::Instant;

use serde_json::Value;

use crate::station::{Booth, PATIENCE};

/// A header of a request.
pub type Header = (&'static str, String);

/// One door of a running station.
pub struct Site {
    pub port: u16,
    pub token: String,
}

/// An answer.
pub struct HttpAnswer {
    pub status: u16,
    head: String,
    pub body: String,
    /// The same before it was read as text.
    pub bytes: Vec<u8>,
}

/// A stream of snapshots.
pub struct Stream {
    status: u16,
    lines: BufReader<TcpStream>,
}

impl Site {
    /// The door of this way, once the station says that it is open.
    pub fn open(booth: &Booth, way: &str) -> Site {
        let said = || {
            let log = booth.log();
            let of_run = log.rsplit("station-open").next()?.to_owned();
            let way = format!("way=\"{way}\"");
            let line = of_run
                .lines()
                .rfind(|line| line.contains("http-listening") && line.contains(&way))?;
            let port: u16 = line.split("port=").nth(1)?.trim().parse().ok()?;
            // A station that has just been started may not have said anything yet.
            TcpStream::connect(("127.0.0.1", port)).ok().map(|_| port)
        };
        let token = || fs::read_to_string(booth.path("state/page-token")).ok();
        booth.wait_for("an open door", || said().is_some() && token().is_some());
        Site { port: said().unwrap(), token: token().unwrap().trim().to_owned() }
    }

    pub fn origin(&self) -> String {
        format!("http://127.0.0.1:{}", self.port)
    }

    /// What the page of somebody with the token sends.
    pub fn operator(&self) -> Vec<Header> {
        vec![
            ("Origin", self.origin()),
            ("Authorization", format!("Bearer {}", self.token)),
            ("Content-Type", "application/json".to_owned()),
        ]
    }

    /// Asks again where an answer takes the station too long, as on a busy machine: that is 503 without a word.
    pub fn get(&self, path: &str, headers: &[Header]) -> HttpAnswer {
        let began = Instant::now();
        loop {
            let answer = self.request("GET", path, "", headers);
            let is_late = answer.status == 503 && answer.body.is_empty();
            if !is_late || began.elapsed() > PATIENCE {
                return answer;
            }
        }
    }

    pub fn post(&self, path: &str, body: &str, headers: &[Header]) -> HttpAnswer {
        self.request("POST", path, body, headers)
    }

    pub fn request(&self, method: &str, path: &str, body: &str, headers: &[Header]) -> HttpAnswer {
        let host = format!("127.0.0.1:{}", self.port);
        self.exchange(method, path, &host, body, headers)
    }

    /// One request under any name of a host, and its answer.
    pub fn exchange(
        &self,
        method: &str,
        path: &str,
        host: &str,
        body: &str,
        headers: &[Header],
    ) -> HttpAnswer {
        let mut stream = self.send(method, path, host, body, headers);
        let mut answer = Vec::new();
        // A server that refuses a body closes before it has read all of it.
        let _ = stream.read_to_end(&mut answer);
        let end = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n");
        let end = end.unwrap_or_else(|| panic!("{:?}", String::from_utf8_lossy(&answer)));
        let bytes = answer.split_off(end + 4);
        let head = String::from_utf8(answer).unwrap();
        let body = String::from_utf8_lossy(&bytes).into_owned();
        HttpAnswer { status: status(&head), head, body, bytes }
    }

    fn send(
        &self,
        method: &str,
        path: &str,
        host: &str,
        body: &str,
        headers: &[Header],
    ) -> TcpStream {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let headers = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n"));
        let headers: String = headers.collect();
        let length = body.len();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\n{headers}\r\n"
        );
        stream.write_all(head.as_bytes()).unwrap();
        let _ = stream.write_all(body.as_bytes());
        stream
    }

    /// What everybody may read.
    pub fn state(&self) -> Value {
        self.state_of(&[])
    }

    pub fn state_of(&self, headers: &[Header]) -> Value {
        serde_json::from_str(&self.get("/state", headers).body).unwrap()
    }

    pub fn stream(&self, headers: &[Header]) -> Stream {
        self.stream_of("/stream", headers)
    }

    pub fn stream_of(&self, path: &str, headers: &[Header]) -> Stream {
        let host = format!("127.0.0.1:{}", self.port);
        let mut lines = BufReader::new(self.send("GET", path, &host, "", headers));
        let mut head = String::new();
        while lines.read_line(&mut head).unwrap() > 2 {}
        Stream { status: status(&head), lines }
    }
}

fn status(head: &str) -> u16 {
    head.split(' ').nth(1).unwrap().parse().unwrap()
}

impl HttpAnswer {
    pub fn header(&self, name: &str) -> Option<String> {
        let lines = self.head.lines().filter_map(|line| line.split_once(": "));
        let mut found = lines.filter(|(of, _)| of.eq_ignore_ascii_case(name));
        found.next().map(|(_, value)| value.to_owned())
    }
}

impl Stream {
    pub fn status(&self) -> u16 {
        self.status
    }
}

/// The snapshots that are told; beats are passed over.
impl Iterator for Stream {
    type Item = Value;

    fn next(&mut self) -> Option<Value> {
        loop {
            let mut line = String::new();
            if self.lines.read_line(&mut line).unwrap() == 0 {
                return None;
            }
            if let Some(text) = line.strip_prefix("data: {") {
                return Some(serde_json::from_str(&format!("{{{text}")).unwrap());
            }
        }
    }
}
