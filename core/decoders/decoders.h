// C interface of the decoders that are written in Rust (core/decoders/src): LAZ and E57.
//
// Available when PCM_HAVE_DECODERS is defined. Functions return a negative number or NULL on failure and write a
// message to `error`, a buffer of `error_bytes`. The message is empty when there is too little memory; then the
// function has done nothing. `coder_bytes` and `memory` bound what the coder's models, or all of a call, may allocate.
// An object belongs to one thread at a time; different objects are independent.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// ---- LAZ ----
// `vlr` is the payload of the VLR "laszip encoded" 22204; its items must have been checked against the point format.

// Decodes one chunk, or consecutive chunks, as a stream.
typedef struct LazDecoder pcm_laz_decoder;

// Reads bytes begin..end of the file `descriptor`, only with positioned reads; the descriptor must stay open until the
// decoder is closed. The head of a layered chunk (point formats 6 to 10) is checked here.
pcm_laz_decoder* pcm_laz_decoder_open(const uint8_t* vlr, size_t vlr_bytes, size_t coder_bytes, int descriptor,
                                      uint64_t begin, uint64_t end, char* error, size_t error_bytes);
size_t pcm_laz_decoder_record_bytes(const pcm_laz_decoder* decoder);
// The number of points as stated in a layered chunk; 0 for others.
uint64_t pcm_laz_decoder_chunk_points(const pcm_laz_decoder* decoder);
// The next `count` records of the chunk. 0, or -1; after that the decoder can only be closed.
int pcm_laz_decode(pcm_laz_decoder* decoder, uint8_t* records, size_t count, char* error, size_t error_bytes);
// The file offset of the next byte: the end of the chunk when all of its records are decoded.
uint64_t pcm_laz_decoder_position(const pcm_laz_decoder* decoder);
void pcm_laz_decoder_close(pcm_laz_decoder* decoder);

// Reads the chunk table at byte `begin` with `chunks` entries: their sizes in bytes and, if the table has them
// (`with_points`), their numbers of points. 0, or -1.
int pcm_laz_chunk_table_read(int descriptor, uint64_t begin, uint64_t end, int with_points, uint64_t* points,
                             uint64_t* bytes, size_t chunks, char* error, size_t error_bytes);

typedef struct LazBytes pcm_laz_bytes;

// Encodes `record_bytes` bytes of whole records as one chunk.
pcm_laz_bytes* pcm_laz_encode_chunk(const uint8_t* vlr, size_t vlr_bytes, size_t coder_bytes, const uint8_t* records,
                                    size_t record_bytes, char* error, size_t error_bytes);
// The table of chunks of a fixed number of points.
pcm_laz_bytes* pcm_laz_encode_chunk_table(const uint64_t* bytes, size_t chunks, char* error, size_t error_bytes);
const uint8_t* pcm_laz_bytes_data(const pcm_laz_bytes* bytes);
size_t pcm_laz_bytes_size(const pcm_laz_bytes* bytes);
void pcm_laz_bytes_free(pcm_laz_bytes* bytes);
// ---- E57 ----
// The contents of a file's header and XML section; the points are decoded by io/e57/e57_packets.
typedef struct E57Description pcm_e57_description;

typedef struct {
    const char* data;  // not terminated; valid until the description is freed
    size_t bytes;
} pcm_e57_text;

typedef struct {
    pcm_e57_text name, guid;
    uint64_t file_offset;  // physical offset of the compressed vector's header
    uint64_t records;
    size_t fields;
    int has_pose;
    double rotation[4];  // quaternion w x y z, as stored in the file
    double translation[3];
    int has_box;  // whether there is a box of the cartesian coordinates before the pose
    double box_min[3], box_max[3];
    int has_colour_limit;
    double colour_limit;  // the highest maximum of red, green and blue
} pcm_e57_scan_info;

typedef struct {
    pcm_e57_text space, name;  // prefix of the extension's namespace, or empty; "cartesianX", "pointSourceId"
    int kind;                  // 0: float, 1: double, 2: integer
    int64_t min, max;          // range of integers: min <= max
    double scale, offset;      // 1 and 0 except for scaled integers
} pcm_e57_field_info;

// Reads the file `descriptor`, only with positioned reads. The caller must have checked the size of the XML section.
pcm_e57_description* pcm_e57_describe(int descriptor, size_t memory, char* error, size_t error_bytes);
pcm_e57_text pcm_e57_xml(const pcm_e57_description* description);
pcm_e57_text pcm_e57_coordinate_metadata(const pcm_e57_description* description);
size_t pcm_e57_images(const pcm_e57_description* description);
size_t pcm_e57_scans(const pcm_e57_description* description);
// 0, or -1 when the scan or field does not exist.
int pcm_e57_scan(const pcm_e57_description* description, size_t scan, pcm_e57_scan_info* to);
int pcm_e57_field(const pcm_e57_description* description, size_t scan, size_t field, pcm_e57_field_info* to);
void pcm_e57_free(pcm_e57_description* description);

#ifdef __cplusplus
}
#endif
