//! Names of files under way, which no two attempts share: on one machine or on several.

use std::fs;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

/// This process: its machine, its number, and when it began, since containers of one machine may
/// share the first two.
pub(in crate::dataset) fn process() -> &'static str {
    static NAME: LazyLock<String> = LazyLock::new(|| {
        let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        let host: String = host.chars().filter(char::is_ascii_alphanumeric).collect();
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let since = since.map_or(0, |time| time.as_nanos());
        format!("{host}-{}-{since:x}", std::process::id())
    });
    &NAME
}

/// Where `path` stands while it is written.
pub(super) fn temporary(path: &str) -> String {
    static FILES: AtomicU64 = AtomicU64::new(0);
    let file = FILES.fetch_add(1, Ordering::Relaxed);
    let name = path.replace('/', "-");
    format!("_sweep/tmp/{name}.{}-{file}.part", process())
}
