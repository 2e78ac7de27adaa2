//! A dataset in object storage, `s3://BUCKET/PREFIX`: an object appears when its upload is
//! complete, and a put can be made to fail where an object stands.
//!
//! Who may write there, and where the service is, say the variables `AWS_*` of the environment.

use std::future::{Future, poll_fn};
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use object_store::aws::AmazonS3Builder;
use object_store::buffered::BufWriter;
use object_store::path::Path as Key;
use object_store::{ObjectStore, ObjectStoreExt, PutMode, PutOptions, PutPayload};
use recordings::FileRecord;
use sha2::{Digest, Sha256};
use tokio::io::AsyncWrite;
use tokio::runtime::{Builder, Runtime};

use crate::Error;

/// Bytes that are read at a time.
const PART: u64 = 8 << 20;
/// How often a request is tried whose connection breaks off.
const TRIES: u32 = 5;

/// The prefix of a bucket.
#[derive(Debug)]
pub(in crate::dataset) struct Bucket {
    url: PathBuf,
    prefix: Key,
    objects: Arc<dyn ObjectStore>,
    runtime: Arc<Runtime>,
}

impl Bucket {
    /// The bucket and prefix `address`, which is what follows `s3://` in `url`.
    pub(super) fn new(url: &Path, address: &str) -> Result<Self, Error> {
        let (bucket, prefix) = address.split_once('/').unwrap_or((address, ""));
        let failed = |error: &dyn std::fmt::Display| failed("open", url, error);
        // Nobody else chooses how connections are encrypted; a second call changes nothing.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let objects = AmazonS3Builder::from_env().with_bucket_name(bucket);
        let runtime = Builder::new_multi_thread()
            .worker_threads(1)
            .enable_all()
            .build();
        Ok(Self {
            url: url.to_owned(),
            prefix: Key::parse(prefix.trim_end_matches('/')).map_err(|e| failed(&e))?,
            objects: Arc::new(objects.build().map_err(|e| failed(&e))?),
            runtime: Arc::new(runtime.map_err(|e| failed(&e))?),
        })
    }

    pub(super) fn path(&self, path: &str) -> PathBuf {
        self.url.join(path)
    }

    fn key(&self, path: &str) -> Key {
        let parts = path.split('/').filter(|part| !part.is_empty());
        parts.fold(self.prefix.clone(), |key, part| key.join(part))
    }

    pub(super) fn create(&self, path: &str) -> ObjectFile {
        ObjectFile {
            out: BufWriter::new(Arc::clone(&self.objects), self.key(path)),
            path: self.path(path),
            runtime: Arc::clone(&self.runtime),
            hash: Sha256::new(),
            bytes: 0,
        }
    }

    pub(super) fn create_only(&self, path: &str, content: &str) -> Result<Option<Vec<u8>>, Error> {
        let key = self.key(path);
        let put = || {
            let payload = PutPayload::from(content.as_bytes().to_vec());
            let options = PutOptions::from(PutMode::Create);
            self.objects.put_opts(&key, payload, options)
        };
        match self.persist(put) {
            Ok(_) => Ok(None),
            // Perhaps by this put, whose answer was lost: the caller compares the content.
            Err(object_store::Error::AlreadyExists { .. }) => self.bytes(path),
            Err(error) => Err(failed("create", &self.path(path), &error)),
        }
    }

    pub(super) fn bytes(&self, path: &str) -> Result<Option<Vec<u8>>, Error> {
        let key = self.key(path);
        let bytes = || async { self.objects.get(&key).await?.bytes().await };
        let content = self.if_exists("read", path, bytes)?;
        Ok(content.map(|content| content.to_vec()))
    }

    pub(super) fn length(&self, path: &str) -> Result<Option<u64>, Error> {
        let key = self.key(path);
        let head = self.if_exists("read", path, || self.objects.head(&key))?;
        Ok(head.map(|object| object.size))
    }

    pub(super) fn modified(&self, path: &str) -> Result<Option<SystemTime>, Error> {
        let key = self.key(path);
        let head = self.if_exists("read", path, || self.objects.head(&key))?;
        Ok(head.map(|object| object.last_modified.into()))
    }

    pub(super) fn range(&self, path: &str, range: Range<u64>) -> Result<Vec<u8>, Error> {
        let key = self.key(path);
        let part = self.persist(|| self.objects.get_range(&key, range.clone()));
        let part = part.map_err(|error| failed("read", &self.path(path), &error))?;
        Ok(part.to_vec())
    }

    pub(super) fn record(&self, path: &str) -> Result<Option<FileRecord>, Error> {
        let Some(bytes) = self.length(path)? else {
            return Ok(None);
        };
        let (key, mut hash) = (self.key(path), Sha256::new());
        for start in (0..bytes).step_by(PART as usize) {
            let range = start..bytes.min(start + PART);
            let part = self.persist(|| self.objects.get_range(&key, range.clone()));
            hash.update(part.map_err(|error| failed("read", &self.path(path), &error))?);
        }
        let sha256 = format!("{:x}", hash.finalize());
        Ok(Some(FileRecord { bytes, sha256 }))
    }

    pub(super) fn names(&self, folder: &str) -> Result<Vec<String>, Error> {
        let key = self.key(folder);
        let listed = self.persist(|| self.objects.list_with_delimiter(Some(&key)));
        let listed = listed.map_err(|error| failed("list", &self.path(folder), &error))?;
        let objects = listed.objects.iter().map(|object| &object.location);
        let names = objects
            .chain(&listed.common_prefixes)
            .filter_map(Key::filename);
        Ok(names.map(str::to_owned).collect())
    }

    pub(super) fn remove(&self, path: &str) -> Result<(), Error> {
        let key = self.key(path);
        self.if_exists("remove", path, || self.objects.delete(&key))
            .map(|_| ())
    }

    /// The result of an action; nothing if there is no object.
    fn if_exists<T, F: Future<Output = Result<T, object_store::Error>>>(
        &self,
        action: &'static str,
        path: &str,
        what: impl Fn() -> F,
    ) -> Result<Option<T>, Error> {
        match self.persist(what) {
            Ok(found) => Ok(Some(found)),
            Err(object_store::Error::NotFound { .. }) => Ok(None),
            Err(error) => Err(failed(action, &self.path(path), &error)),
        }
    }

    /// Does `what` until it gets an answer, or has been tried often enough.
    fn persist<T, F: Future<Output = Result<T, object_store::Error>>>(
        &self,
        what: impl Fn() -> F,
    ) -> Result<T, object_store::Error> {
        use object_store::Error::{AlreadyExists, NotFound};
        let mut tries = 1;
        loop {
            match self.runtime.block_on(what()) {
                Err(error)
                    if tries < TRIES
                        && !matches!(error, AlreadyExists { .. } | NotFound { .. }) =>
                {
                    std::thread::sleep(Duration::from_secs(1));
                    tries += 1;
                }
                done => return done,
            }
        }
    }
}

/// An object under way, which is not visible before [`ObjectFile::commit`]. Large ones are sent in
/// parts while they are written.
pub(in crate::dataset) struct ObjectFile {
    out: BufWriter,
    path: PathBuf,
    runtime: Arc<Runtime>,
    hash: Sha256,
    bytes: u64,
}

impl ObjectFile {
    pub(super) fn record(&self) -> FileRecord {
        FileRecord {
            bytes: self.bytes,
            sha256: format!("{:x}", self.hash.clone().finalize()),
        }
    }

    pub(super) fn commit(mut self) -> Result<FileRecord, Error> {
        let out = &mut self.out;
        let end = poll_fn(|context| Pin::new(&mut *out).poll_shutdown(context));
        let ended = self.runtime.block_on(end);
        ended.map_err(|error| failed("write", &self.path, &error))?;
        Ok(self.record())
    }
}

impl Write for ObjectFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let out = &mut self.out;
        let write = poll_fn(|context| Pin::new(&mut *out).poll_write(context, bytes));
        let named =
            |error| io::Error::other(format!("cannot write `{}`: {error}", self.path.display()));
        let written = self.runtime.block_on(write).map_err(named)?;
        self.hash.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    /// Nothing is sent before its part is full.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn failed(action: &'static str, path: &Path, error: &dyn std::fmt::Display) -> Error {
    Error::File(recordings::Error::Io {
        action,
        path: path.to_owned(),
        source: io::Error::other(error.to_string()),
    })
}
