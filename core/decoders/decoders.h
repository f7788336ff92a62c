// C interface of the decoders that are written in Rust (core/decoders/src): LAZ and E57.
//
// Present when PCM_HAVE_DECODERS is defined. Functions return a negative number or NULL on failure and put a message
// into `error`, a buffer of `error_bytes`. An object belongs to one thread at a time; different objects are
// independent.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// ---- LAZ ----
// `vlr` is the payload of the VLR "laszip encoded" 22204; its items must have been checked against the point format.

// One chunk, or chunks that follow each other, decoded as a stream.
typedef struct LazDecoder pcm_laz_decoder;

// Reads from bytes begin..end of the file behind `descriptor`, which stays open as long as the decoder lives, with
// read_at only. Of a layered chunk (point formats 6 to 10) its head is checked here.
pcm_laz_decoder* pcm_laz_decoder_open(const uint8_t* vlr, size_t vlr_bytes, int descriptor, uint64_t begin,
                                      uint64_t end, char* error, size_t error_bytes);
size_t pcm_laz_decoder_record_bytes(const pcm_laz_decoder* decoder);
// What a layered chunk says about itself; 0 for others.
uint64_t pcm_laz_decoder_chunk_points(const pcm_laz_decoder* decoder);
// The next `count` records of the chunk. 0, or -1; after that the decoder can only be closed.
int pcm_laz_decode(pcm_laz_decoder* decoder, uint8_t* records, size_t count, char* error, size_t error_bytes);
// Where in the file the next byte would come from: behind the chunk when all of its records are decoded.
uint64_t pcm_laz_decoder_position(const pcm_laz_decoder* decoder);
void pcm_laz_decoder_close(pcm_laz_decoder* decoder);

// The chunk table at byte `begin`, which says it has `chunks` entries: their bytes and, where the table has them
// (`with_points`), their points. 0, or -1.
int pcm_laz_chunk_table_read(int descriptor, uint64_t begin, uint64_t end, int with_points, uint64_t* points,
                             uint64_t* bytes, size_t chunks, char* error, size_t error_bytes);

typedef struct LazBytes pcm_laz_bytes;

// `record_bytes` bytes of whole records as one chunk.
pcm_laz_bytes* pcm_laz_encode_chunk(const uint8_t* vlr, size_t vlr_bytes, const uint8_t* records, size_t record_bytes,
                                    char* error, size_t error_bytes);
// The table of chunks of a fixed number of points.
pcm_laz_bytes* pcm_laz_encode_chunk_table(const uint64_t* bytes, size_t chunks, char* error, size_t error_bytes);
const uint8_t* pcm_laz_bytes_data(const pcm_laz_bytes* bytes);
size_t pcm_laz_bytes_size(const pcm_laz_bytes* bytes);
void pcm_laz_bytes_free(pcm_laz_bytes* bytes);
// ---- E57 ----
// What the header and the XML section of a file say; the points are decoded by io/e57_packets.
typedef struct E57Description pcm_e57_description;

typedef struct {
    const char* data;  // not terminated; valid as long as the description
    size_t bytes;
} pcm_e57_text;

typedef struct {
    pcm_e57_text name, guid;
    uint64_t file_offset;  // of the compressed vector's header, a physical one
    uint64_t records;
    size_t fields;
    int has_pose;
    double rotation[4];  // quaternion w x y z, as it stands in the file
    double translation[3];
    int has_box;  // of the cartesian coordinates before the pose
    double box_min[3], box_max[3];
    int has_colour_limit;
    double colour_limit;  // largest of the maxima of red, green and blue
} pcm_e57_scan_info;

typedef struct {
    pcm_e57_text space, name;  // prefix of the extension's namespace or nothing; "cartesianX", "pointSourceId"
    int kind;                  // 0: float, 1: double, 2: integer
    int64_t min, max;          // of integers: min <= max
    double scale, offset;      // 1 and 0 but for scaled integers
} pcm_e57_field_info;

// Reads the file behind `descriptor`, with read_at only. The caller has looked at the size of the XML section.
pcm_e57_description* pcm_e57_describe(int descriptor, char* error, size_t error_bytes);
pcm_e57_text pcm_e57_xml(const pcm_e57_description* description);
pcm_e57_text pcm_e57_coordinate_metadata(const pcm_e57_description* description);
size_t pcm_e57_images(const pcm_e57_description* description);
size_t pcm_e57_scans(const pcm_e57_description* description);
// 0, or -1 where there is no such scan or field.
int pcm_e57_scan(const pcm_e57_description* description, size_t scan, pcm_e57_scan_info* to);
int pcm_e57_field(const pcm_e57_description* description, size_t scan, size_t field, pcm_e57_field_info* to);
void pcm_e57_free(pcm_e57_description* description);

#ifdef __cplusplus
}
#endif
