//! Minimal HTTP server of a few files for a browser on the local machine: GET and HEAD, one request and one thread per
//! connection.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longest request head that is read, bytes.
const MAX_HEAD: u64 = 16 << 10;
/// Timeout for reading a request, and for a blocked write: a silent or slow browser does not hold a connection for
/// ever.
const PATIENCE: Duration = Duration::from_secs(30);
/// Maximum number of open connections; further connections are closed.
const MOST_OPEN: usize = 256;
/// Pause after a failed accept.
const BREATH: Duration = Duration::from_millis(20);

/// Parts of a request that determine the response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// The method, for example `GET` or `HEAD`.
    pub method: String,
    /// The text after the method, as sent.
    pub target: String,
    /// The header `Host`.
    pub host: Option<String>,
}

/// An HTTP response.
pub struct Response {
    /// The status code, for example 200.
    pub status: u16,
    /// The header `Content-Type`.
    pub mime: &'static str,
    /// The contents.
    pub body: ResponseBody,
}

/// Contents of a response.
pub enum ResponseBody {
    /// In memory.
    Bytes(&'static [u8]),
    /// A sentence.
    Text(String),
    /// Read during sending.
    File(File),
}

/// Answers every connection, in a thread per connection. Ends only if the listener fails permanently.
///
/// # Errors
/// If the listener can accept no further connection.
pub fn serve(
    listener: &TcpListener,
    headers: &'static [(&str, &str)],
    answer: impl Fn(&Request) -> Response + Send + Sync + 'static,
) -> io::Result<()> {
    serve_for(PATIENCE, listener, headers, answer)
}

/// [`serve`], with the timeout `patience`.
fn serve_for(
    patience: Duration,
    listener: &TcpListener,
    headers: &'static [(&str, &str)],
    answer: impl Fn(&Request) -> Response + Send + Sync + 'static,
) -> io::Result<()> {
    let answer = Arc::new(answer);
    let open = Arc::new(());
    loop {
        let stream = match listener.accept() {
            Ok((stream, _)) => stream,
            // The peer has disconnected, or too many files are open at present.
            Err(error)
                if !matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) =>
            {
                std::thread::sleep(BREATH);
                continue;
            }
            Err(error) => return Err(error),
        };
        if Arc::strong_count(&open) > MOST_OPEN {
            continue;
        }
        let (answer, is_open) = (answer.clone(), open.clone());
        // If no thread can be started, the connection is closed.
        let _ = std::thread::Builder::new().spawn(move || {
            // A disconnected browser is no error.
            let _ = converse(&stream, patience, headers, answer.as_ref());
            drop(is_open);
        });
    }
}

/// Reader with a deadline.
struct Until<'a> {
    stream: &'a TcpStream,
    end: Instant,
}

impl Read for Until<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        self.stream.set_read_timeout(Some(left))?;
        self.stream.read(into)
    }
}

fn converse(
    mut stream: &TcpStream,
    patience: Duration,
    headers: &[(&str, &str)],
    answer: &impl Fn(&Request) -> Response,
) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(patience))?;
    let request = read_request(Until { stream, end: Instant::now() + patience })?;
    let response = match &request {
        Some(request) => answer(request),
        None => {
            let text = ResponseBody::Text("this is no request that is understood here".into());
            Response { status: 400, mime: "text/plain; charset=utf-8", body: text }
        }
    };
    let len = match &response.body {
        ResponseBody::Bytes(bytes) => bytes.len() as u64,
        ResponseBody::Text(text) => text.len() as u64,
        ResponseBody::File(file) => file.metadata()?.len(),
    };
    let mut head = format!(
        "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {len}\r\nConnection: close\r\n",
        response.status,
        reason(response.status),
        response.mime
    );
    if response.status == 405 {
        head.push_str("Allow: GET, HEAD\r\n");
    }
    for (name, value) in headers {
        head.push_str(&format!("{name}: {value}\r\n"));
    }
    head.push_str("\r\n");
    stream.write_all(head.as_bytes())?;
    if request.is_none_or(|request| request.method != "HEAD") {
        match response.body {
            ResponseBody::Bytes(bytes) => stream.write_all(bytes)?,
            ResponseBody::Text(text) => stream.write_all(text.as_bytes())?,
            // A file that shrinks meanwhile ends early; the browser notices by the content length.
            ResponseBody::File(file) => {
                io::copy(&mut file.take(len), &mut stream)?;
            }
        }
    }
    // Closing with unread bytes of the peer would cut the response off.
    stream.shutdown(Shutdown::Write)?;
    let rest = Until { stream, end: Instant::now() + Duration::from_secs(1) };
    io::copy(&mut rest.take(MAX_HEAD), &mut io::sink())?;
    Ok(())
}

/// Reads a request's head; `None` if malformed.
fn read_request(stream: impl Read) -> io::Result<Option<Request>> {
    let mut lines = BufReader::new(stream.take(MAX_HEAD)).lines();
    // A line that is not UTF-8 is malformed.
    let mut next = || match lines.next().transpose() {
        Err(error) if error.kind() == io::ErrorKind::InvalidData => Ok(None),
        line => line,
    };
    let Some(first) = next()? else { return Ok(None) };
    let words: Vec<&str> = first.split(' ').collect();
    let [method, target, version] = words[..] else { return Ok(None) };
    if !version.starts_with("HTTP/1.") {
        return Ok(None);
    }
    let mut request = Request { method: method.into(), target: target.into(), host: None };
    while let Some(line) = next()? {
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
mod tests;
