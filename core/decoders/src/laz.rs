//! LAZ chunks: compressed bytes to raw LAS records, and back.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::mem::ManuallyDrop;
use std::os::fd::FromRawFd;
use std::os::raw::{c_char, c_int};
use std::os::unix::fs::FileExt;

use laz::laszip::{ChunkTable, LazItem, LazItemType, LazVlr};
use laz::record::{
    LayeredPointRecordCompressor, LayeredPointRecordDecompressor, RecordCompressor, RecordDecompressor,
    SequentialPointRecordCompressor, SequentialPointRecordDecompressor,
};

use crate::error::guard;

const BUFFER_BYTES: usize = 1 << 16;
/// Layers are decoded in parallel, so all layers of a chunk are in memory.
const MOST_LAYER_BYTES: u64 = 96 << 20;
const CODER_OF_TABLE_BYTES: usize = 4 << 20;
/// Messages, vectors of items and other small things.
const SMALL_BYTES: usize = 1 << 20;

/// A range of a borrowed open file, with its own buffer: several can read the same file.
struct FileRange {
    file: ManuallyDrop<File>,
    end: u64,
    /// The file offset of the buffer.
    start_of_buffer: u64,
    buffer: Vec<u8>,
    used: usize,
}

impl FileRange {
    fn new(descriptor: c_int, begin: u64, end: u64) -> Self {
        // The descriptor is borrowed: ManuallyDrop leaves it open.
        let file = ManuallyDrop::new(unsafe { File::from_raw_fd(descriptor) });
        FileRange { file, end, start_of_buffer: begin, buffer: Vec::new(), used: 0 }
    }

    fn position(&self) -> u64 {
        self.start_of_buffer + self.used as u64
    }

    fn refill(&mut self) -> io::Result<()> {
        self.start_of_buffer += self.buffer.len() as u64;
        self.used = 0;
        let left = self.end.saturating_sub(self.start_of_buffer);
        self.buffer.resize(left.min(BUFFER_BYTES as u64) as usize, 0);
        let mut got = 0;
        while got < self.buffer.len() {
            match self.file.read_at(&mut self.buffer[got..], self.start_of_buffer + got as u64) {
                Ok(0) => break,
                Ok(count) => got += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => {
                    self.buffer.clear();
                    return Err(error);
                }
            }
        }
        self.buffer.truncate(got);
        Ok(())
    }
}

impl Read for FileRange {
    #[inline]
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.used == self.buffer.len() {
            self.refill()?;
        }
        let count = to.len().min(self.buffer.len() - self.used);
        to[..count].copy_from_slice(&self.buffer[self.used..self.used + count]);
        self.used += count;
        Ok(count)
    }

    /// The arithmetic decoder takes its bytes one by one.
    #[inline]
    fn read_exact(&mut self, to: &mut [u8]) -> io::Result<()> {
        if to.len() <= self.buffer.len() - self.used {
            to.copy_from_slice(&self.buffer[self.used..self.used + to.len()]);
            self.used += to.len();
            return Ok(());
        }
        let mut got = 0;
        while got < to.len() {
            match self.read(&mut to[got..])? {
                0 => return Err(ErrorKind::UnexpectedEof.into()),
                count => got += count,
            }
        }
        Ok(())
    }
}

impl Seek for FileRange {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let target = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(by) => self.position().checked_add_signed(by),
            SeekFrom::End(by) => self.end.checked_add_signed(by),
        };
        self.start_of_buffer = target.ok_or(ErrorKind::InvalidInput)?;
        self.buffer.clear();
        self.used = 0;
        Ok(self.start_of_buffer)
    }
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn io_text(error: io::Error) -> String {
    match error.kind() {
        ErrorKind::UnexpectedEof => "the compressed bytes end early".to_string(),
        _ => error.to_string(),
    }
}

/// The items of the laszip VLR, of one kind only: sequential (versions 1, 2) or layered (3, 4).
fn items_of(vlr: &[u8]) -> Result<(Vec<LazItem>, bool), String> {
    let vlr = LazVlr::from_buffer(vlr).map_err(text)?;
    let items = vlr.items().clone();
    let first = items.first().ok_or("the laszip VLR lists no items")?;
    let layered = first.version() >= 3;
    if items.iter().any(|item| (item.version() >= 3) != layered) {
        return Err("the laszip VLR mixes layered and sequential items".to_string());
    }
    Ok((items, layered))
}

fn layer_count(items: &[LazItem]) -> usize {
    items
        .iter()
        .map(|item| match item.item_type() {
            LazItemType::Point14 => 9,
            LazItemType::RGBNIR14 => 2,
            LazItemType::Byte14(count) => count as usize,
            _ => 1,
        })
        .sum()
}

pub struct LazDecoder {
    records: Box<dyn RecordDecompressor<FileRange>>,
    record_bytes: usize,
    chunk_points: u64,
    /// What a call may allocate.
    memory: usize,
}

/// The number of points and of bytes of the layers as stated in a layered chunk. The layers must lie inside the range,
/// because the decompressor allocates memory for their stated sizes.
fn check_layers(range: &mut FileRange, items: &[LazItem], record_bytes: usize) -> Result<(u64, usize), String> {
    let begin = range.position();
    let mut head = vec![0u8; record_bytes + 4 + 4 * layer_count(items)];
    range.read_exact(&mut head).map_err(io_text)?;
    let number = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("four bytes"));
    let points = number(&head[record_bytes..record_bytes + 4]);
    let layers: u64 = head[record_bytes + 4..].chunks_exact(4).map(|size| u64::from(number(size))).sum();
    let left = range.end.saturating_sub(range.position());
    if layers > left {
        return Err(format!("its layers are said to have {layers} bytes, {left} are left"));
    }
    if layers > MOST_LAYER_BYTES {
        return Err(format!("its layers have {layers} bytes; at most {MOST_LAYER_BYTES} can be read"));
    }
    range.seek(SeekFrom::Start(begin)).map_err(io_text)?;
    Ok((u64::from(points), layers as usize))
}

fn decoder(vlr: &[u8], coder_bytes: usize, descriptor: c_int, begin: u64, end: u64) -> Result<LazDecoder, String> {
    let (items, layered) = items_of(vlr)?;
    let mut range = FileRange::new(descriptor, begin, end);
    let (mut chunk_points, mut layer_bytes) = (0, 0);
    let mut records: Box<dyn RecordDecompressor<FileRange>> = if layered {
        let record_bytes = items.iter().map(|item| item.size() as usize).sum();
        (chunk_points, layer_bytes) = check_layers(&mut range, &items, record_bytes)?;
        Box::new(LayeredPointRecordDecompressor::new(range))
    } else {
        Box::new(SequentialPointRecordDecompressor::new(range))
    };
    records.set_fields_from(&items).map_err(text)?;
    let record_bytes = records.record_size();
    Ok(LazDecoder { records, record_bytes, chunk_points, memory: coder_bytes + layer_bytes + SMALL_BYTES })
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_decoder_open(
    vlr: *const u8, vlr_bytes: usize, coder_bytes: usize, descriptor: c_int, begin: u64, end: u64, error: *mut c_char,
    error_bytes: usize,
) -> *mut LazDecoder {
    guard(error, error_bytes, std::ptr::null_mut(), coder_bytes + SMALL_BYTES, || {
        let vlr = std::slice::from_raw_parts(vlr, vlr_bytes);
        Ok(Box::into_raw(Box::new(decoder(vlr, coder_bytes, descriptor, begin, end)?)))
    })
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_decode(
    decoder: *mut LazDecoder, records: *mut u8, count: usize, error: *mut c_char, error_bytes: usize,
) -> c_int {
    let decoder = &mut *decoder;
    let memory = decoder.memory;
    guard(error, error_bytes, -1, memory, || {
        let out = std::slice::from_raw_parts_mut(records, count * decoder.record_bytes);
        decoder.records.decompress_many(out).map_err(io_text)?;
        Ok(0)
    })
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_decoder_position(decoder: *const LazDecoder) -> u64 {
    (*decoder).records.get().position()
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_decoder_record_bytes(decoder: *const LazDecoder) -> usize {
    (*decoder).record_bytes
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_decoder_chunk_points(decoder: *const LazDecoder) -> u64 {
    (*decoder).chunk_points
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_decoder_close(decoder: *mut LazDecoder) {
    if !decoder.is_null() {
        drop(Box::from_raw(decoder));
    }
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_chunk_table_read(
    descriptor: c_int, begin: u64, end: u64, with_points: c_int, points: *mut u64, bytes: *mut u64, chunks: usize,
    error: *mut c_char, error_bytes: usize,
) -> c_int {
    let table_bytes = chunks * 2 * std::mem::size_of::<laz::laszip::ChunkTableEntry>();
    guard(error, error_bytes, -1, table_bytes + CODER_OF_TABLE_BYTES + SMALL_BYTES, || {
        let mut range = FileRange::new(descriptor, begin, end);
        let mut head = [0u8; 8];
        range.read_exact(&mut head).map_err(io_text)?;
        let count = u32::from_le_bytes(head[4..].try_into().expect("four bytes"));
        if count as usize != chunks {
            return Err(format!("{count} chunks found, {chunks} were expected"));
        }
        range.seek(SeekFrom::Start(begin)).map_err(io_text)?;
        let table = ChunkTable::read(&mut range, with_points != 0).map_err(io_text)?;
        for (i, entry) in table.as_ref().iter().enumerate() {
            // The format stores both as 32 bits.
            *points.add(i) = entry.point_count & 0xFFFF_FFFF;
            *bytes.add(i) = entry.byte_count & 0xFFFF_FFFF;
        }
        Ok(0)
    })
}

pub struct LazBytes(Vec<u8>);

fn compressed(mut compressor: impl RecordCompressor<Vec<u8>>, items: &Vec<LazItem>, records: &[u8]) -> Result<Vec<u8>, String> {
    compressor.set_fields_from(items).map_err(text)?;
    if compressor.record_size() == 0 || records.len() % compressor.record_size() != 0 {
        return Err(format!("{} bytes are no records of {}", records.len(), compressor.record_size()));
    }
    compressor.compress_many(records).map_err(text)?;
    compressor.done().map_err(text)?;
    Ok(compressor.into_inner())
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_encode_chunk(
    vlr: *const u8, vlr_bytes: usize, coder_bytes: usize, records: *const u8, record_bytes: usize, error: *mut c_char,
    error_bytes: usize,
) -> *mut LazBytes {
    // The compressed bytes grow in steps, and those of layers are copied at the end.
    let memory = coder_bytes + 6 * record_bytes + SMALL_BYTES;
    guard(error, error_bytes, std::ptr::null_mut(), memory, || {
        let (items, layered) = items_of(std::slice::from_raw_parts(vlr, vlr_bytes))?;
        let records = std::slice::from_raw_parts(records, record_bytes);
        let chunk = if layered {
            compressed(LayeredPointRecordCompressor::new(Vec::new()), &items, records)?
        } else {
            compressed(SequentialPointRecordCompressor::new(Vec::new()), &items, records)?
        };
        Ok(Box::into_raw(Box::new(LazBytes(chunk))))
    })
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_encode_chunk_table(
    bytes: *const u64, chunks: usize, error: *mut c_char, error_bytes: usize,
) -> *mut LazBytes {
    let table_bytes = chunks * 6 * std::mem::size_of::<laz::laszip::ChunkTableEntry>();
    guard(error, error_bytes, std::ptr::null_mut(), table_bytes + CODER_OF_TABLE_BYTES + SMALL_BYTES, || {
        let mut table = ChunkTable::with_capacity(chunks);
        for i in 0..chunks {
            let byte_count = *bytes.add(i);
            table.push(laz::laszip::ChunkTableEntry { point_count: 0, byte_count });
        }
        // Any VLR with chunks of a fixed size will do: the table then holds no numbers of points.
        let vlr = laz::LazVlrBuilder::default().with_point_format(0, 0).map_err(text)?.build();
        let mut to = Vec::new();
        table.write_to(&mut to, &vlr).map_err(text)?;
        Ok(Box::into_raw(Box::new(LazBytes(to))))
    })
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_bytes_data(bytes: *const LazBytes) -> *const u8 {
    (*bytes).0.as_ptr()
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_bytes_size(bytes: *const LazBytes) -> usize {
    (*bytes).0.len()
}

/// # Safety
/// See decoders.h.
#[no_mangle]
pub unsafe extern "C" fn pcm_laz_bytes_free(bytes: *mut LazBytes) {
    if !bytes.is_null() {
        drop(Box::from_raw(bytes));
    }
}
