//! The file beside a report's JSON: what its figures over time are drawn from, as compact JSON in gzip.
//!
//! Equal reports give equal bytes. The file names the reports it belongs to by their SHA-256, so that a file
//! an earlier run left is not taken for this one's.

use crate::verbs::{Beside, Report, Series};
use flate2::{Compression, bufread::GzDecoder, write::GzEncoder};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::io::Read;

/// How the file is called: as the JSON, with this instead of its extension.
pub const EXTENSION: &str = "series";

/// More than this, unpacked, is no file of ours.
const BYTES: u64 = 1 << 30;

#[derive(Serialize, Deserialize)]
struct File<S> {
    /// SHA-256 of the reports' compact JSON.
    reports: String,
    /// One a report.
    series: Vec<Option<S>>,
}

/// The bytes of the file; None where no report has series.
pub fn pack(reports: &[Report]) -> Option<Vec<u8>> {
    let series: Vec<Option<&Series>> = reports.iter().map(Report::series).collect();
    series.iter().any(Option::is_some).then(|| {
        let reports = digest(reports);
        let mut gzip = GzEncoder::new(Vec::new(), Compression::fast());
        // Neither numbers nor memory refuse to be written.
        let _ = serde_json::to_writer(&mut gzip, &File { reports, series });
        gzip.finish().unwrap_or_default()
    })
}

/// The reports with the series of their file. Where that is no such file, or belongs to other reports, they stay
/// as they are: series are [`Beside::Missing`].
#[must_use]
pub fn unpack(reports: Vec<Report>, file: &[u8]) -> Vec<Report> {
    let mut text = Vec::new();
    let read = GzDecoder::new(file).take(BYTES).read_to_end(&mut text);
    let file = serde_json::from_slice(&text).ok().filter(|_| read.is_ok());
    let Some(File::<Series> { series, .. }) =
        file.filter(|file: &File<_>| file.reports == digest(&reports))
    else {
        return reports;
    };
    let whole = |(report, series): (Report, Option<Series>)| Report {
        beside: series.map_or(report.beside, Beside::Here),
        ..report
    };
    let series = series.into_iter().chain(std::iter::repeat_with(|| None));
    reports.into_iter().zip(series).map(whole).collect()
}

fn digest(reports: &[Report]) -> String {
    let text = serde_json::to_vec(reports).unwrap_or_default();
    let bytes = Sha256::digest(&text);
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
