//! The file beside a report's JSON: the series its figures over time are drawn from, as compact JSON in gzip.
//!
//! Equal reports give equal bytes. The file names the reports it belongs to by their SHA-256, so that a file
//! of an earlier run is not taken for this one's.

use crate::verbs::{Report, Series, SeriesState};
use flate2::{Compression, bufread::GzDecoder, write::GzEncoder};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::io::Read;

/// The file's extension; its stem is that of the JSON.
pub const EXTENSION: &str = "series";

/// The largest unpacked size, bytes; no file of this program has more.
const MAX_BYTES: u64 = 1 << 30;

#[derive(Serialize, Deserialize)]
struct File<S> {
    /// SHA-256 of the reports' compact JSON.
    reports: String,
    /// The series of each report.
    series: Vec<Option<S>>,
}

/// The bytes of the file; None where no report has series.
pub fn pack(reports: &[Report]) -> Option<Vec<u8>> {
    let series: Vec<Option<&Series>> = reports.iter().map(Report::series).collect();
    series.iter().any(Option::is_some).then(|| {
        let reports = digest(reports);
        let mut gzip = GzEncoder::new(Vec::new(), Compression::fast());
        // Writing numbers to memory cannot fail.
        let _ = serde_json::to_writer(&mut gzip, &File { reports, series });
        gzip.finish().unwrap_or_default()
    })
}

/// The reports with the series of their file. Where it is no such file, or belongs to other reports, they stay
/// as they are: their series are [`SeriesState::Missing`].
#[must_use]
pub fn unpack(reports: Vec<Report>, file: &[u8]) -> Vec<Report> {
    let mut text = Vec::new();
    let read = GzDecoder::new(file).take(MAX_BYTES).read_to_end(&mut text);
    let file = serde_json::from_slice(&text).ok().filter(|_| read.is_ok());
    let Some(File::<Series> { series, .. }) =
        file.filter(|file: &File<_>| file.reports == digest(&reports))
    else {
        return reports;
    };
    let loaded = |(report, series): (Report, Option<Series>)| Report {
        series: series.map_or(report.series, SeriesState::Loaded),
        ..report
    };
    let series = series.into_iter().chain(std::iter::repeat_with(|| None));
    reports.into_iter().zip(series).map(loaded).collect()
}

fn digest(reports: &[Report]) -> String {
    let text = serde_json::to_vec(reports).unwrap_or_default();
    let bytes = Sha256::digest(&text);
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
