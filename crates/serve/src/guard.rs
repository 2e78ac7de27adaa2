//! Which requests are answered.
//!
//! A page of another site can send requests to this address, and with a name that it has made to mean 127.0.0.1 (DNS
//! rebinding) it could read the answers. The name stands in `Host`, so that only the names of this machine are answered.

use crate::answer::Answer;
use hyper::header::HOST;
use hyper::{Method, Request, StatusCode};

/// The names of this machine.
const NAMES: [&str; 2] = ["127.0.0.1", "localhost"];

/// Refuses what is not a request to read, by a name of this machine and at `port`.
pub(crate) fn refuse<B>(request: &Request<B>, port: u16) -> Option<Answer> {
    let hosts: Vec<&[u8]> = request
        .headers()
        .get_all(HOST)
        .iter()
        .map(|h| h.as_bytes())
        .collect();
    let named = request
        .uri()
        .authority()
        .map(|authority| authority.as_str().as_bytes());
    // A request for a whole address has the name twice.
    let is_own = matches!(hosts.as_slice(), [one] if is_own_name(one, port))
        && named.is_none_or(|name| is_own_name(name, port));
    if !is_own {
        let why = format!("expected the host 127.0.0.1:{port} or localhost:{port}");
        return Some(Answer::refusal(StatusCode::FORBIDDEN, why));
    }
    if ![Method::GET, Method::HEAD].contains(request.method()) {
        let why = "expected GET or HEAD: nothing is written here";
        return Some(Answer::refusal(StatusCode::METHOD_NOT_ALLOWED, why));
    }
    None
}

/// Whether `host` is a name of this machine with its `port`, which may be left out if it is that of HTTP.
fn is_own_name(host: &[u8], port: u16) -> bool {
    let Ok(host) = std::str::from_utf8(host) else {
        return false;
    };
    let (name, at) = match host.rsplit_once(':') {
        Some((name, at)) => (name, at.to_owned()),
        None => (host, "80".to_owned()),
    };
    at == port.to_string() && NAMES.iter().any(|own| name.eq_ignore_ascii_case(own))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_this_machine_are_its_own() {
        for own in ["127.0.0.1:8723", "localhost:8723", "LocalHost:8723"] {
            assert!(is_own_name(own.as_bytes(), 8723), "{own}");
        }
        let others = [
            "127.0.0.1",
            "127.0.0.1:80",
            "evil.example:8723",
            "localhost.evil.example:8723",
            "",
            ":8723",
            "127.0.0.1:8723:8723",
        ];
        for other in others {
            assert!(!is_own_name(other.as_bytes(), 8723), "{other}");
        }
        assert!(is_own_name(b"localhost", 80));
        assert!(!is_own_name(b"\xff:8723", 8723));
    }
}
