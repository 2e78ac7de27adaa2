//! Connections: taken one by one, answered side by side, each bounded in what it may send and how long it may take.
//!
//! One thread waits for all connections. What is answered is made on threads of its own, so that a page that takes long
//! holds nobody up. A connection carries one request.

use crate::Error;
use crate::answer::Answer;
use crate::guard;
use crate::place::Place;
use crate::site::{AtHand, Site};
use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Request, Response};
use hyper_util::rt::{TokioIo, TokioTimer};
use std::convert::Infallible;
use std::net::{SocketAddr, TcpListener};
use std::path::Path;
use std::pin::pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::{Duration, Instant};
use tokio::net::TcpStream;
use tokio::runtime::Builder;
use tokio::sync::Semaphore;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::{sleep, timeout};

/// Connections at the same time.
const MOST_CONNECTIONS: usize = 128;
/// Bytes of a request's line and headers, and headers.
const MOST_REQUEST_BYTES: usize = 16 << 10;
const MOST_HEADERS: usize = 64;
/// So long may a client take to send its request, and to receive the answer.
const REQUEST_TIME: Duration = Duration::from_secs(10);
const ANSWER_TIME: Duration = Duration::from_secs(60);
/// How often it is looked whether to end.
const GLANCE: Duration = Duration::from_millis(50);

/// A folder that is served at an address.
#[derive(Debug)]
pub struct Server {
    root: std::path::PathBuf,
    named: std::path::PathBuf,
    listener: TcpListener,
    address: SocketAddr,
}

struct Shared {
    site: Site,
    port: u16,
    /// What is made at the same time: as many as there are processors.
    work: Semaphore,
}

impl Server {
    /// Listens at `address`, one of this machine alone, for `folder`. Port 0 is any that is free.
    ///
    /// # Errors
    /// [`Error::NoFolder`], [`Error::NotLoopback`], [`Error::InUse`], or [`Error::Listen`].
    pub fn bind(folder: &Path, address: SocketAddr) -> Result<Self, Error> {
        let no_folder = |error| Error::NoFolder {
            folder: folder.to_owned(),
            error,
        };
        let root = folder.canonicalize().map_err(no_folder)?;
        std::fs::read_dir(&root).map_err(no_folder)?;
        if !address.ip().is_loopback() {
            return Err(Error::NotLoopback(address));
        }
        let failed = |error: std::io::Error| match error.kind() {
            std::io::ErrorKind::AddrInUse => Error::InUse(address),
            _ => Error::Listen { address, error },
        };
        let listener = TcpListener::bind(address).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        Ok(Self {
            address: listener.local_addr().map_err(failed)?,
            root,
            named: folder.to_owned(),
            listener,
        })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Answers until `stop` is set. What is under way then is given up.
    ///
    /// # Errors
    /// [`Error::Listen`] where the system gives no means to wait for connections.
    pub fn run(self, stop: Arc<AtomicBool>) -> Result<(), Error> {
        let address = self.address;
        let failed = |error| Error::Listen { address, error };
        let shared = Arc::new(Shared {
            site: Site::new(self.root, self.named, Arc::clone(&stop)),
            port: address.port(),
            work: Semaphore::new(thread::available_parallelism().map_or(1, usize::from)),
        });
        let runtime = Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .build();
        let runtime = runtime.map_err(failed)?;
        let served = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(self.listener)?;
            take_connections(&listener, &shared, &stop).await;
            Ok(())
        });
        runtime.shutdown_background();
        served.map_err(failed)
    }
}

async fn take_connections(
    listener: &tokio::net::TcpListener,
    shared: &Arc<Shared>,
    stop: &AtomicBool,
) {
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    while !stop.load(Ordering::Relaxed) {
        let Ok(Ok(place)) = timeout(GLANCE, Arc::clone(&places).acquire_owned()).await else {
            continue;
        };
        match timeout(GLANCE, listener.accept()).await {
            Ok(Ok((stream, _))) => {
                let shared = Arc::clone(shared);
                tokio::spawn(async move {
                    serve(stream, shared).await;
                    drop(place);
                });
            }
            // No file handle is left, or the client has gone: others may come later.
            Ok(Err(_)) => sleep(GLANCE).await,
            Err(_) => {}
        }
    }
}

/// Answers the request of a connection, and closes it.
async fn serve(stream: TcpStream, shared: Arc<Shared>) {
    let answered: OnceLock<Instant> = OnceLock::new();
    let service = service_fn(|request| {
        let shared = Arc::clone(&shared);
        let answered = &answered;
        async move {
            let response = respond(&request, shared).await;
            let _ = answered.set(Instant::now());
            Ok::<_, Infallible>(response)
        }
    });
    let mut http = http1::Builder::new();
    http.keep_alive(false)
        .max_buf_size(MOST_REQUEST_BYTES)
        .max_headers(MOST_HEADERS)
        .timer(TokioTimer::new())
        .header_read_timeout(REQUEST_TIME);
    let mut connection = pin!(http.serve_connection(TokioIo::new(stream), service));
    // Nobody is told where a connection ends: a client that has gone needs no answer.
    while timeout(REQUEST_TIME, connection.as_mut()).await.is_err() {
        if answered.get().is_some_and(|at| at.elapsed() > ANSWER_TIME) {
            return;
        }
    }
}

async fn respond(request: &Request<Incoming>, shared: Arc<Shared>) -> Response<Full<Bytes>> {
    let answer = match guard::refuse(request, shared.port) {
        Some(refused) => refused,
        None => match Place::parse(request.uri().path()) {
            Some(place) => answer(place, shared).await,
            None => Answer::nothing(),
        },
    };
    answer.response()
}

async fn answer(place: Place, shared: Arc<Shared>) -> Answer {
    let (at, of) = (place.clone(), Arc::clone(&shared));
    match spawn_blocking(move || of.site.find(&at)).await {
        Ok(AtHand::Yes(answer)) => return answer,
        Ok(AtHand::No) => {}
        Err(error) => return panicked(error),
    }
    let of = Arc::clone(&shared);
    let Ok(_turn) = shared.work.acquire().await else {
        return Answer::nothing();
    };
    let made = spawn_blocking(move || of.site.make(&place)).await;
    made.unwrap_or_else(panicked)
}

/// The answer in place of one whose making panicked.
fn panicked(error: JoinError) -> Answer {
    let why = match error.try_into_panic() {
        Ok(panic) => match (panic.downcast_ref::<String>(), panic.downcast_ref::<&str>()) {
            (Some(message), _) => message.clone(),
            (None, Some(message)) => (*message).to_owned(),
            (None, None) => "unknown".to_owned(),
        },
        Err(error) => error.to_string(),
    };
    Answer::failure(format!(
        "the page could not be made, which is a mistake of this program: {why}"
    ))
}
