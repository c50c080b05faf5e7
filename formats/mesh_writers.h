/* What the mesh writers share: where bytes go, the records they are made of, places in the
 * world. A writer gets a mesh that is checked and not empty; for a local file its origin is 0.
 */
#ifndef FORMATS_MESH_WRITERS_H
#define FORMATS_MESH_WRITERS_H

#include <cubewright/formats.h>

#include "core/outfile.h"

#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_mesh_output {
    cwi_outfile *file;
    const char *name; /* of the object; printable UTF-8 on one line, at most 255 bytes */
    const double
        *local_origin; /* what gives the world's coordinates when added; NULL: nothing */
    const cw_progress *progress;
    size_t done, total; /* records, for progress; a writer sets the total */
} cwi_mesh_output;

typedef cw_status cwi_mesh_writer(const cw_mesh *mesh, cwi_mesh_output *out, cw_error *err);

CW_API cwi_mesh_writer cwi_stl_write;
CW_API cwi_mesh_writer cwi_ply_write;
CW_API cwi_mesh_writer cwi_obj_write;
CW_API cwi_mesh_writer cwi_glb_write;
CW_API cwi_mesh_writer cwi_gltf_write;

/* Loads the module that both glTF writers need. CW_ERR_UNSUPPORTED: not in this build. */
CW_API cw_status cwi_gltf_prepare(cw_error *err);

enum { CWI_RECORD_BYTES = 256 }; /* room for any record, binary or a line of text */

/* Puts record i at to; returns the end of it. */
typedef unsigned char *cwi_record_encoder(const cw_mesh *mesh, size_t i, unsigned char *to);

/* Writes records 0 to count - 1 and reports progress on the way. */
cw_status cwi_write_records(const cw_mesh *mesh, cwi_mesh_output *out,
                            cwi_record_encoder *encode, size_t count, cw_error *err);

enum { CWI_ORIGIN_BYTES = 128 };

/* The origin of a local file as text, first what stands before it: " from 1 2 3.5". Empty for a
 * file of world coordinates. */
void cwi_print_origin(const cwi_mesh_output *out, const char *before, const char *after,
                      char text[CWI_ORIGIN_BYTES]);

/* cw_mesh_write_loss() of a file in world coordinates; loss is zeroed. */
cw_status cwi_measure_loss(const cw_mesh *mesh, cw_write_loss *loss, cw_error *err);

/* CW_ERR_LIMIT when a world coordinate is beyond single precision's largest number. */
cw_status cwi_check_single(const cw_mesh *mesh, cw_error *err);

/* Little endian on any machine; each returns the end of what it put. */
static inline unsigned char *cwi_put_u16(unsigned char *to, uint16_t value)
{
    to[0] = (unsigned char)(value & 255);
    to[1] = (unsigned char)(value >> 8);
    return to + 2;
}

static inline unsigned char *cwi_put_u32(unsigned char *to, uint32_t value)
{
    return cwi_put_u16(cwi_put_u16(to, (uint16_t)(value & 65535)), (uint16_t)(value >> 16));
}

static inline unsigned char *cwi_put_f32(unsigned char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return cwi_put_u32(to, bits);
}

static inline unsigned char *cwi_put_f32x3(unsigned char *to, const float value[3])
{
    for (int a = 0; a < 3; a++)
        to = cwi_put_f32(to, value[a]);
    return to;
}

/* Summed in double: a position keeps its micrometres until the format takes them. */
static inline double cwi_world_coordinate(const cw_mesh *mesh, size_t vertex, int axis)
{
    return mesh->origin[axis] + (double)mesh->positions[3 * vertex + (size_t)axis];
}

#ifdef __cplusplus
}
#endif

#endif
