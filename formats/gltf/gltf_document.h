/* The content of a glTF file that is written: its arrays and the places of their bytes. The
 * module "gltf" makes the JSON from it; the bytes are written separately. */
#ifndef FORMATS_GLTF_GLTF_DOCUMENT_H
#define FORMATS_GLTF_GLTF_DOCUMENT_H

#include "formats/codec/draco_wrap.h"
#include "formats/mesh/color_groups.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum cwi_gltf_use {
    CWI_GLTF_INDICES,
    CWI_GLTF_POSITION,
    CWI_GLTF_NORMAL,
    CWI_GLTF_COLOR,
    CWI_GLTF_TEXTURE,
    CWI_GLTF_TANGENT,
    CWI_GLTF_USES
} cwi_gltf_use;

/* An accessor and its view. */
typedef struct cwi_gltf_array {
    cwi_gltf_use use;
    int component, numbers; /* component type, 5120 to 5126; numbers in an element, 1 to 4 */
    bool normalized;
    bool exponential;           /* meshopt: a filter turns its numbers into floats */
    uint64_t count, stride;     /* elements, and bytes from one to the next */
    uint64_t at;                /* place in the buffer, or (meshopt) in the buffer that no file
                                   has */
    uint64_t packed_at, packed; /* meshopt: place and number of its compressed bytes */
} cwi_gltf_array;

/* The pictures of a material. */
enum {
    CWI_GLTF_NORMAL_PICTURE,
    CWI_GLTF_COLOR_PICTURE,
    CWI_GLTF_METALLIC_PICTURE,
    CWI_GLTF_OCCLUSION_PICTURE,
    CWI_GLTF_EMISSIVE_PICTURE,
    CWI_GLTF_PICTURES
};

/* A picture in the buffer. */
typedef struct cwi_gltf_image {
    cw_texture file;
    uint64_t at; /* its place there */
} cwi_gltf_image;

/* A node with a mesh of one primitive, or of one for each colour. */
typedef struct cwi_gltf_piece {
    const cwi_part *part;
    bool has_pictures;
    size_t images[CWI_GLTF_PICTURES]; /* of the document's images, from 1 on; 0: none */
    float (*tangents)[4];             /* vertices; NULL: none are written */
    cwi_color_groups groups;          /* a primitive each; none: there is one primitive */
    cwi_gltf_array arrays[CWI_GLTF_USES];
    size_t array_count;
    double low[3], high[3]; /* box of POSITION, as it is stored */
    double translation[3];  /* mm, LPS: of the stored positions, ... */
    double step;            /* ... which are multiples of this many mm */
    bool translucent;
    uint64_t draco_at, draco; /* place and number of Draco's bytes; 0: no Draco */
    cwi_draco_ids ids;
    float times[4]; /* keys of its scale, if there is an animation: seconds, ... */
    size_t time_count, first_scale; /* ... and the index of the first key's scale */
} cwi_gltf_piece;

typedef struct cwi_gltf_document {
    const cwi_gltf_piece *pieces;
    size_t count;
    const cw_provenance *provenance;
    size_t provenance_count;
    const double *local_origin; /* stated in the extras of nodes; NULL: applied */
    cwi_gltf_image *images;     /* behind everything else */
    size_t image_count;
    double end_s;       /* of the animation that shows one piece at a time; 0: none */
    uint64_t keys_at;   /* place of the animation's numbers: scale_count scales, */
    size_t scale_count; /* then the times of every piece */
    bool quantized;     /* integers for positions or normals: KHR_mesh_quantization */
    uint64_t bytes;     /* of the buffer */
    uint64_t unpacked;  /* meshopt: size of the buffer that no file has; else 0 */
} cwi_gltf_document;

#ifdef __cplusplus
}
#endif

#endif
