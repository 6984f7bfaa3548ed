//! Responses to valid and malformed requests, over TCP.

use super::*;

fn parse(text: &str) -> Option<Request> {
    read_request(text.as_bytes()).unwrap()
}

#[test]
fn a_request_is_its_method_target_and_host() {
    let request = parse("GET /a?b HTTP/1.1\r\nAccept: */*\r\nhOST:  127.0.0.1:80\r\n\r\n").unwrap();
    let expected = Request { method: "GET".into(), target: "/a?b".into(), host: Some("127.0.0.1:80".into()) };
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
            "/bytes" => Response { status: 200, mime: "a/b", body: ResponseBody::Bytes(&BYTES) },
            _ => Response { status: 404, mime: "text/plain", body: ResponseBody::Text("no".into()) },
        })
    });
    // Silent connections, as browsers open in advance.
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

static HEADERS: [(&str, &str); 1] = [("X-Test", "yes")];

/// Timeout that shows a hang even on a busy machine.
const HANGS: Duration = Duration::from_secs(600);

/// Starts a server that returns the target of a request, and the file under `/file`.
fn server(file: Option<std::path::PathBuf>) -> std::net::SocketAddr {
    server_for(HANGS, file)
}

/// Like `server`, with the timeout `patience`.
fn server_for(patience: Duration, file: Option<std::path::PathBuf>) -> std::net::SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        serve_for(patience, &listener, &HEADERS, move |request| match (request.target.as_str(), &file) {
            ("/file", Some(path)) => {
                Response { status: 200, mime: "a/b", body: ResponseBody::File(File::open(path).unwrap()) }
            }
            ("/not", _) => Response { status: 405, mime: "a/b", body: ResponseBody::Text("no".into()) },
            (target, _) => {
                Response { status: 200, mime: "text/plain", body: ResponseBody::Text(target.into()) }
            }
        })
    });
    address
}

/// Sends `bytes` and returns the response, to the end.
fn answer(address: std::net::SocketAddr, bytes: &[u8]) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(bytes).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
fn whatever_is_sent_is_answered_once_and_closed() {
    let address = server(None);
    let long = format!("GET / HTTP/1.1\r\nX: {}\r\n\r\n", "x".repeat(3 * MAX_HEAD as usize));
    let many = format!("GET / HTTP/1.1\r\n{}\r\n", "A: b\r\n".repeat(MAX_HEAD as usize));
    let bad: [&[u8]; 10] = [
        b"\r\n\r\n",
        b"GET\r\n\r\n",
        b"GET /\r\n\r\n",
        b"GET / HTTP/2\r\n\r\n",
        b"GET  / HTTP/1.1\r\n\r\n",
        b"GET /\xff\xfe HTTP/1.1\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n",
        b"GET / HTTP/1.1\r\nno header\r\n\r\n",
        long.as_bytes(),
        many.as_bytes(),
    ];
    for bytes in bad {
        let answer = answer(address, bytes);
        assert!(
            answer.starts_with("HTTP/1.1 400 Bad Request\r\n"),
            "{:?}: {answer}",
            &bytes[..8.min(bytes.len())]
        );
        assert!(
            answer.contains("\r\nX-Test: yes\r\n") && answer.matches("HTTP/1.1").count() == 1,
            "{answer}"
        );
    }
    // The bytes after a request are not a second request.
    let two = answer(address, b"GET /a HTTP/1.1\r\n\r\nGET /b HTTP/1.1\r\n\r\n");
    assert!(two.ends_with("\r\n\r\n/a") && two.matches("HTTP/1.1").count() == 1, "{two}");
    // Ranges are not supported: the response is complete, without range headers.
    let part = answer(address, b"GET /a HTTP/1.1\r\nRange: bytes=1-1\r\n\r\n");
    assert!(part.starts_with("HTTP/1.1 200 OK") && part.ends_with("\r\n\r\n/a"), "{part}");
    assert!(answer(address, b"PUT /not HTTP/1.1\r\n\r\n").contains("\r\nAllow: GET, HEAD\r\n"));
}

#[test]
fn slow_and_silent_clients_hold_nobody_up() {
    let address = server(None);
    let mut slow = TcpStream::connect(address).unwrap();
    let _silent = TcpStream::connect(address).unwrap();
    slow.write_all(b"G").unwrap();
    assert!(answer(address, b"GET /now HTTP/1.1\r\n\r\n").ends_with("/now"));
}

#[test]
fn slow_and_silent_clients_are_let_go() {
    let patience = Duration::from_millis(500);
    let address = server_for(patience, None);
    let began = Instant::now();
    let mut slow = TcpStream::connect(address).unwrap();
    let silent = TcpStream::connect(address).unwrap();
    // A byte now and then, for ever: the timeout covers the entire head, not the time between bytes.
    while slow.write_all(b"G").is_ok() {
        assert!(began.elapsed() < HANGS, "it was never let go");
        std::thread::sleep(patience / 10);
    }
    let mut nothing = Vec::new();
    let _ = (&silent).read_to_end(&mut nothing);
    assert!(nothing.is_empty() && began.elapsed() >= patience);
}

#[test]
fn more_connections_than_fit_are_closed_and_later_ones_answered() {
    let address = server(None);
    let crowd: Vec<_> = (0..MOST_OPEN + 40).filter_map(|_| TcpStream::connect(address).ok()).collect();
    std::thread::sleep(Duration::from_millis(100));
    drop(crowd);
    let began = Instant::now();
    loop {
        let mut stream = TcpStream::connect(address).unwrap();
        let _ = stream.write_all(b"GET /still HTTP/1.1\r\n\r\n");
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        if answer.ends_with(b"/still") {
            return;
        }
        assert!(began.elapsed() < HANGS, "nobody is answered any more");
    }
}

#[test]
fn a_file_that_shrinks_while_it_is_sent_ends_short_of_the_length_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rbn");
    let length = 64 << 20;
    File::create(&path).unwrap().set_len(length).unwrap();
    let mut stream = TcpStream::connect(server(Some(path.clone()))).unwrap();
    stream.write_all(b"GET /file HTTP/1.1\r\n\r\n").unwrap();
    let mut start = [0; 1000];
    stream.read_exact(&mut start).unwrap();
    assert!(String::from_utf8_lossy(&start).contains(&format!("Content-Length: {length}\r\n")));
    // Socket buffers hold a few megabytes of the file.
    File::options().write(true).open(&path).unwrap().set_len(1000).unwrap();
    let rest = io::copy(&mut stream, &mut io::sink()).unwrap();
    assert!(rest < length - 1000, "{rest}");
}
