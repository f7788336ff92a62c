//! E57: the contents of a file's header and XML section. The points are decoded by io/e57/e57_packets.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::mem::ManuallyDrop;
use std::os::fd::FromRawFd;
use std::os::raw::{c_char, c_int};
use std::os::unix::fs::FileExt;

use e57::{E57Reader, PointCloud, RecordDataType, RecordName, RecordValue};

use crate::error::guard;

/// A borrowed open file, with its own position.
struct BorrowedFile {
    file: ManuallyDrop<File>,
    position: u64,
}

impl Read for BorrowedFile {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let got = self.file.read_at(to, self.position)?;
        self.position += got as u64;
        Ok(got)
    }
}

impl Seek for BorrowedFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let place = match to {
            SeekFrom::Start(offset) => Some(offset),
            SeekFrom::Current(step) => self.position.checked_add_signed(step),
            SeekFrom::End(step) => self.file.metadata()?.len().checked_add_signed(step),
        };
        self.position = place.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "a seek out of range"))?;
        Ok(self.position)
    }
}

/// Text that belongs to the description.
#[repr(C)]
pub struct Text {
    data: *const u8,
    bytes: usize,
}

impl From<&str> for Text {
    fn from(text: &str) -> Self {
        Text { data: text.as_ptr(), bytes: text.len() }
    }
}

#[repr(C)]
pub struct E57Scan {
    name: Text,
    guid: Text,
    file_offset: u64,
    records: u64,
    fields: usize,
    has_pose: c_int,
    rotation: [f64; 4],
    translation: [f64; 3],
    has_box: c_int,
    box_min: [f64; 3],
    box_max: [f64; 3],
    has_colour_limit: c_int,
    colour_limit: f64,
}

#[repr(C)]
pub struct E57Field {
    space: Text,
    name: Text,
    kind: c_int,
    min: i64,
    max: i64,
    scale: f64,
    offset: f64,
}

pub struct E57Description {
    xml: String,
    coordinate_metadata: String,
    images: usize,
    scans: Vec<PointCloud>,
}

/// The name of a field of the standard.
fn standard_name(name: &RecordName) -> &str {
    match name {
        RecordName::CartesianX => "cartesianX",
        RecordName::CartesianY => "cartesianY",
        RecordName::CartesianZ => "cartesianZ",
        RecordName::CartesianInvalidState => "cartesianInvalidState",
        RecordName::SphericalRange => "sphericalRange",
        RecordName::SphericalAzimuth => "sphericalAzimuth",
        RecordName::SphericalElevation => "sphericalElevation",
        RecordName::SphericalInvalidState => "sphericalInvalidState",
        RecordName::Intensity => "intensity",
        RecordName::IsIntensityInvalid => "isIntensityInvalid",
        RecordName::ColorRed => "colorRed",
        RecordName::ColorGreen => "colorGreen",
        RecordName::ColorBlue => "colorBlue",
        RecordName::IsColorInvalid => "isColorInvalid",
        RecordName::RowIndex => "rowIndex",
        RecordName::ColumnIndex => "columnIndex",
        RecordName::ReturnCount => "returnCount",
        RecordName::ReturnIndex => "returnIndex",
        RecordName::TimeStamp => "timeStamp",
        RecordName::IsTimeStampInvalid => "isTimeStampInvalid",
        RecordName::Unknown { name, .. } => name,
    }
}

fn number(value: &Option<RecordValue>) -> Option<f64> {
    Some(match value.as_ref()? {
        RecordValue::Single(value) => f64::from(*value),
        RecordValue::Double(value) => *value,
        RecordValue::ScaledInteger(value) | RecordValue::Integer(value) => *value as f64,
    })
}

impl E57Scan {
    fn of(cloud: &PointCloud) -> Self {
        let bounds = cloud.cartesian_bounds.as_ref();
        let corners = bounds.and_then(|b| Some(([b.x_min?, b.y_min?, b.z_min?], [b.x_max?, b.y_max?, b.z_max?])));
        let (box_min, box_max) = corners.unwrap_or_default();
        let pose = cloud.transform.clone().unwrap_or_default();
        let limits = cloud.color_limits.as_ref();
        let colour_limit = limits.and_then(|l| {
            Some(number(&l.red_max)?.max(number(&l.green_max)?).max(number(&l.blue_max)?))
        });
        E57Scan {
            name: cloud.name.as_deref().unwrap_or_default().into(),
            guid: cloud.guid.as_deref().unwrap_or_default().into(),
            file_offset: cloud.file_offset,
            records: cloud.records,
            fields: cloud.prototype.len(),
            has_pose: cloud.transform.is_some().into(),
            rotation: [pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z],
            translation: [pose.translation.x, pose.translation.y, pose.translation.z],
            has_box: corners.is_some().into(),
            box_min,
            box_max,
            has_colour_limit: colour_limit.is_some().into(),
            colour_limit: colour_limit.unwrap_or_default(),
        }
    }
}

/// # Safety
/// `descriptor` is that of an open file; `error` points to `error_bytes` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn pcm_e57_describe(
    descriptor: c_int,
    memory: usize,
    error: *mut c_char,
    error_bytes: usize,
) -> *mut E57Description {
    guard(error, error_bytes, std::ptr::null_mut(), memory, || {
        // The descriptor is borrowed: ManuallyDrop leaves it open.
        let file = ManuallyDrop::new(unsafe { File::from_raw_fd(descriptor) });
        let file = BufReader::new(BorrowedFile { file, position: 0 });
        let reader = E57Reader::new(file).map_err(|error| error.to_string())?;
        Ok(Box::into_raw(Box::new(E57Description {
            xml: reader.xml().to_string(),
            coordinate_metadata: reader.coordinate_metadata().unwrap_or_default().to_string(),
            images: reader.images().len(),
            scans: reader.pointclouds(),
        })))
    })
}

/// # Safety
/// `description` is one of pcm_e57_describe() that is not freed.
#[no_mangle]
pub unsafe extern "C" fn pcm_e57_xml(description: *const E57Description) -> Text {
    (*description).xml.as_str().into()
}

/// # Safety
/// As pcm_e57_xml().
#[no_mangle]
pub unsafe extern "C" fn pcm_e57_coordinate_metadata(description: *const E57Description) -> Text {
    (*description).coordinate_metadata.as_str().into()
}

/// # Safety
/// As pcm_e57_xml().
#[no_mangle]
pub unsafe extern "C" fn pcm_e57_images(description: *const E57Description) -> usize {
    (*description).images
}

/// # Safety
/// As pcm_e57_xml().
#[no_mangle]
pub unsafe extern "C" fn pcm_e57_scans(description: *const E57Description) -> usize {
    (*description).scans.len()
}

/// # Safety
/// As pcm_e57_xml(); `to` is writable. 0, or -1 when the scan does not exist.
#[no_mangle]
pub unsafe extern "C" fn pcm_e57_scan(description: *const E57Description, scan: usize, to: *mut E57Scan) -> c_int {
    match (&(*description).scans).get(scan) {
        Some(cloud) => {
            to.write(E57Scan::of(cloud));
            0
        }
        None => -1,
    }
}

/// # Safety
/// As pcm_e57_scan().
#[no_mangle]
pub unsafe extern "C" fn pcm_e57_field(
    description: *const E57Description,
    scan: usize,
    field: usize,
    to: *mut E57Field,
) -> c_int {
    let Some(record) = (&(*description).scans).get(scan).and_then(|cloud| cloud.prototype.get(field)) else {
        return -1;
    };
    let space = match &record.name {
        RecordName::Unknown { namespace, .. } => namespace.as_str(),
        _ => "",
    };
    let (kind, min, max, scale, offset) = match record.data_type {
        RecordDataType::Single { .. } => (0, 0, 0, 1.0, 0.0),
        RecordDataType::Double { .. } => (1, 0, 0, 1.0, 0.0),
        RecordDataType::Integer { min, max } => (2, min, max, 1.0, 0.0),
        RecordDataType::ScaledInteger { min, max, scale, offset } => (2, min, max, scale, offset),
    };
    to.write(E57Field { space: space.into(), name: standard_name(&record.name).into(), kind, min, max, scale, offset });
    0
}

/// # Safety
/// `description` is one of pcm_e57_describe(), or null, and not used afterwards.
#[no_mangle]
pub unsafe extern "C" fn pcm_e57_free(description: *mut E57Description) {
    if !description.is_null() {
        drop(Box::from_raw(description));
    }
}
