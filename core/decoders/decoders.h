// C interface of the decoders that are written in Rust (core/decoders/src): LAZ and E57.
//
// Present when PCM_HAVE_DECODERS is defined. Functions return a negative number or NULL on failure and put a message into
// `error`, a buffer of `error_bytes`. An object belongs to one thread at a time; different objects are independent.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __cplusplus
}
#endif
