//! Just enough HTTP to hand a few files to a browser on the same machine: GET and HEAD, one request
//! a connection, one thread a connection.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::time::Duration;

/// Longest request head that is read, bytes.
const MAX_HEAD: u64 = 16 << 10;
/// A browser that opens a connection and says nothing does not hold it for ever.
const PATIENCE: Duration = Duration::from_secs(30);

/// The part of a request that answers depend on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// `GET`, `HEAD` or something else.
    pub method: String,
    /// What follows the method, as sent.
    pub target: String,
    /// The header `Host`.
    pub host: Option<String>,
}

/// What is sent back.
pub struct Response {
    /// Such as 200.
    pub status: u16,
    /// The header `Content-Type`.
    pub mime: &'static str,
    /// The contents.
    pub body: Body,
}

/// Contents of a response.
pub enum Body {
    /// In memory.
    Bytes(&'static [u8]),
    /// A sentence.
    Text(String),
    /// Read while it is sent.
    File(File),
}

/// Answers every connection, each in a thread of its own. Ends only if accepting fails.
///
/// # Errors
/// If no connection can be accepted any more.
pub fn serve(
    listener: &TcpListener,
    headers: &'static [(&str, &str)],
    answer: impl Fn(&Request) -> Response + Send + Sync + 'static,
) -> io::Result<()> {
    let answer = Arc::new(answer);
    loop {
        let (stream, _) = listener.accept()?;
        let answer = answer.clone();
        std::thread::spawn(move || {
            // A browser that has gone away is no error here.
            let _ = converse(&stream, headers, answer.as_ref());
        });
    }
}

fn converse(
    mut stream: &TcpStream,
    headers: &[(&str, &str)],
    answer: &impl Fn(&Request) -> Response,
) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_nodelay(true)?;
    let Some(request) = read_request(stream)? else {
        return stream
            .write_all(b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
    };
    let response = answer(&request);
    let len = match &response.body {
        Body::Bytes(bytes) => bytes.len() as u64,
        Body::Text(text) => text.len() as u64,
        Body::File(file) => file.metadata()?.len(),
    };
    let mut head = format!(
        "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {len}\r\nConnection: close\r\n",
        response.status,
        reason(response.status),
        response.mime
    );
    for (name, value) in headers {
        head.push_str(&format!("{name}: {value}\r\n"));
    }
    head.push_str("\r\n");
    stream.write_all(head.as_bytes())?;
    if request.method != "HEAD" {
        match response.body {
            Body::Bytes(bytes) => stream.write_all(bytes)?,
            Body::Text(text) => stream.write_all(text.as_bytes())?,
            Body::File(file) => {
                io::copy(&mut file.take(len), &mut stream)?;
            }
        }
    }
    // Closing while the other side still has something unread to us would cut the answer off.
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(Duration::from_secs(1)))?;
    io::copy(&mut stream.take(MAX_HEAD), &mut io::sink())?;
    Ok(())
}

/// Reads a request's head; `None` if it is none.
fn read_request(stream: impl Read) -> io::Result<Option<Request>> {
    let mut lines = BufReader::new(stream.take(MAX_HEAD)).lines();
    let Some(first) = lines.next() else { return Ok(None) };
    let first = first?;
    let words: Vec<&str> = first.split(' ').collect();
    let [method, target, version] = words[..] else { return Ok(None) };
    if !version.starts_with("HTTP/1.") {
        return Ok(None);
    }
    let mut request = Request { method: method.into(), target: target.into(), host: None };
    for line in lines {
        let line = line?;
        if line.is_empty() {
            return Ok(Some(request));
        }
        let Some((name, value)) = line.split_once(':') else { return Ok(None) };
        if name.eq_ignore_ascii_case("host") && request.host.replace(value.trim().to_owned()).is_some() {
            return Ok(None);
        }
    }
    Ok(None)
}

fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Option<Request> {
        read_request(text.as_bytes()).unwrap()
    }

    #[test]
    fn a_request_is_its_method_target_and_host() {
        let request = parse("GET /a?b HTTP/1.1\r\nAccept: */*\r\nhOST:  127.0.0.1:80\r\n\r\n").unwrap();
        let expected =
            Request { method: "GET".into(), target: "/a?b".into(), host: Some("127.0.0.1:80".into()) };
        assert_eq!(request, expected);
        assert_eq!(parse("HEAD / HTTP/1.0\n\n").unwrap().host, None);
    }

    #[test]
    fn what_is_no_whole_request_is_refused() {
        let long = format!("GET / HTTP/1.1\r\nX: {}\r\n\r\n", "x".repeat(MAX_HEAD as usize));
        let twice = "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n";
        for text in ["", "GET /\r\n\r\n", "GET / HTTP/1.1\r\nHost: a", "GET / FTP\r\n\r\n", twice, &long] {
            assert_eq!(parse(text), None, "{}", &text[..text.len().min(40)]);
        }
    }

    #[test]
    fn many_connections_at_once_are_all_answered() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        static BYTES: [u8; 100_000] = [7; 100_000];
        std::thread::spawn(move || {
            serve(&listener, &[("X-Test", "yes")], |request| match request.target.as_str() {
                "/bytes" => Response { status: 200, mime: "a/b", body: Body::Bytes(&BYTES) },
                _ => Response { status: 404, mime: "text/plain", body: Body::Text("no".into()) },
            })
        });
        // Connections that say nothing, as browsers open them in advance.
        let _silent: Vec<_> = (0..8).map(|_| TcpStream::connect(address).unwrap()).collect();
        let ask = |line: &str| {
            let mut stream = TcpStream::connect(address).unwrap();
            stream.write_all(format!("{line} HTTP/1.1\r\nHost: x\r\n\r\n").as_bytes()).unwrap();
            let mut answer = Vec::new();
            stream.read_to_end(&mut answer).unwrap();
            let end = answer.windows(4).position(|w| w == b"\r\n\r\n").unwrap() + 4;
            let body = answer.split_off(end);
            (String::from_utf8(answer).unwrap(), body)
        };
        for _ in 0..20 {
            let (head, body) = ask("GET /bytes");
            assert!(head.starts_with("HTTP/1.1 200 OK\r\n") && head.contains("X-Test: yes\r\n"), "{head}");
            assert_eq!(body, BYTES);
        }
        let (head, body) = ask("HEAD /bytes");
        assert!(head.contains("Content-Length: 100000\r\n") && body.is_empty(), "{head}");
        assert!(ask("GET /other").0.starts_with("HTTP/1.1 404 "));
    }
}
