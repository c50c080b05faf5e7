/* What is in a glTF file that we write: its arrays and where their bytes lie. The module "gltf"
 * makes the JSON of it; the bytes are written beside. */
#ifndef FORMATS_GLTF_GLTF_DOCUMENT_H
#define FORMATS_GLTF_GLTF_DOCUMENT_H

#include "formats/codec/draco_wrap.h"
#include "formats/mesh/mesh_writer.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum cwi_gltf_use {
    CWI_GLTF_INDICES,
    CWI_GLTF_POSITION,
    CWI_GLTF_NORMAL,
    CWI_GLTF_COLOR,
    CWI_GLTF_USES
} cwi_gltf_use;

/* An accessor and its view. */
typedef struct cwi_gltf_array {
    cwi_gltf_use use;
    int component, numbers; /* 5120 to 5126; of an element, 1 to 4 */
    bool normalized;
    bool exponential;           /* meshopt: a filter makes its numbers floats */
    uint64_t count, stride;     /* elements, and bytes from one to the next */
    uint64_t at;                /* in the buffer, or (meshopt) in the one that is never there */
    uint64_t packed_at, packed; /* meshopt: where its bytes are, and how many */
} cwi_gltf_array;

/* A node with a mesh of one primitive. */
typedef struct cwi_gltf_piece {
    const cwi_part *part;
    cwi_gltf_array arrays[CWI_GLTF_USES];
    size_t array_count;
    double low[3], high[3]; /* of POSITION, as it is stored */
    double translation[3];  /* mm, LPS: of the stored positions, ... */
    double step;            /* ... which are multiples of this many mm */
    bool translucent;
    uint64_t draco_at, draco; /* where Draco's bytes are, and how many; 0: not Draco's */
    cwi_draco_ids ids;
    float times[4]; /* keys of its scale, if there is an animation: seconds, ... */
    size_t time_count, first_scale; /* ... and which of the scales belongs to the first */
} cwi_gltf_piece;

typedef struct cwi_gltf_document {
    const cwi_gltf_piece *pieces;
    size_t count;
    const cw_provenance *provenance;
    size_t provenance_count;
    const double *local_origin; /* told in the extras of nodes; NULL: applied */
    double end_s;               /* of the animation that shows one piece at a time; 0: none */
    uint64_t keys_at;   /* where its numbers are: so many scales, then the times of ... */
    size_t scale_count; /* ... every piece */
    bool quantized;     /* integers for positions or normals: KHR_mesh_quantization */
    uint64_t bytes;     /* of the buffer */
    uint64_t unpacked;  /* meshopt: of the buffer that is never there; else 0 */
} cwi_gltf_document;

#ifdef __cplusplus
}
#endif

#endif
