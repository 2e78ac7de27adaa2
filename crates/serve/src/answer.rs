//! What is sent back.

use crate::policy;
use http_body_util::Full;
use hyper::body::Bytes;
use hyper::header::{self, HeaderValue};
use hyper::{Response, StatusCode};

/// An answer to a request.
#[derive(Clone, Debug)]
pub(crate) struct Answer {
    status: StatusCode,
    content_type: &'static str,
    body: Bytes,
    /// The content security policy.
    policy: String,
    /// Where the answer is, if elsewhere.
    location: Option<String>,
}

impl Answer {
    fn new(content_type: &'static str, body: impl Into<Bytes>) -> Self {
        Self {
            status: StatusCode::OK,
            content_type,
            body: body.into(),
            policy: policy::NOTHING.to_owned(),
            location: None,
        }
    }

    /// A page whose own scripts and styles are allowed to run.
    pub(crate) fn page(html: String) -> Self {
        Self {
            policy: policy::policy_of(&html),
            ..Self::new("text/html; charset=utf-8", html)
        }
    }

    /// A part of a page, which runs nothing by itself.
    pub(crate) fn fragment(html: String) -> Self {
        Self::new("text/html; charset=utf-8", html)
    }

    /// A document for programs.
    pub(crate) fn json(text: String) -> Self {
        Self::new("application/json", text)
    }

    /// A figure.
    pub(crate) fn svg(text: String) -> Self {
        Self::new("image/svg+xml", text)
    }

    /// The way to the path `to`, which is encoded.
    pub(crate) fn elsewhere(to: String) -> Self {
        Self {
            status: StatusCode::TEMPORARY_REDIRECT,
            location: Some(to),
            ..Self::new("text/plain; charset=utf-8", "")
        }
    }

    /// A request that is not answered as it was meant, and why.
    pub(crate) fn refusal(status: StatusCode, why: impl Into<String>) -> Self {
        Self {
            status,
            ..Self::new("text/plain; charset=utf-8", why.into() + "\n")
        }
    }

    /// There is nothing at the path.
    pub(crate) fn nothing() -> Self {
        Self::refusal(StatusCode::NOT_FOUND, "there is no such page")
    }

    /// The page could not be made.
    pub(crate) fn failure(why: impl ToString) -> Self {
        Self::refusal(StatusCode::INTERNAL_SERVER_ERROR, why.to_string())
    }

    /// Bytes that it takes in memory.
    pub(crate) fn size(&self) -> usize {
        self.body.len() + self.policy.len()
    }

    /// As it is sent.
    pub(crate) fn response(&self) -> Response<Full<Bytes>> {
        let mut response = Response::new(Full::new(self.body.clone()));
        *response.status_mut() = self.status;
        let headers = response.headers_mut();
        for (name, value) in [
            (header::CONTENT_TYPE, self.content_type),
            (header::CACHE_CONTROL, "no-store"),
            (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
            (header::REFERRER_POLICY, "no-referrer"),
        ] {
            headers.insert(name, HeaderValue::from_static(value));
        }
        let own = HeaderValue::from_static("same-origin");
        headers.insert("cross-origin-resource-policy", own);
        headers.insert(header::CONTENT_LENGTH, self.body.len().into());
        let policy = HeaderValue::from_str(&self.policy);
        let allow = self.status == StatusCode::METHOD_NOT_ALLOWED;
        let more = [
            (header::CONTENT_SECURITY_POLICY, policy.ok()),
            (
                header::ALLOW,
                allow.then(|| HeaderValue::from_static("GET, HEAD")),
            ),
            (
                header::LOCATION,
                self.location
                    .as_ref()
                    .and_then(|to| HeaderValue::from_str(to).ok()),
            ),
        ];
        headers.extend(
            more.into_iter()
                .filter_map(|(name, value)| Some((name, value?))),
        );
        response
    }
}
