/* What the mesh writers share: where bytes go, the records they are made of, places in the
 * world. */
#ifndef FORMATS_MESH_MESH_WRITER_H
#define FORMATS_MESH_MESH_WRITER_H

#include <cubewright/formats.h>

#include "core/base/atomic_file.h"
#include "formats/bytes/little_endian.h"
#include "formats/mesh/mesh_axes.h"
#include "formats/text/number_format.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_NAME_BYTES = 256, CWI_RECORD_BYTES = 512 };

/* A part as a writer gets it: checked, with triangles. */
typedef struct cwi_part {
    cw_mesh mesh;  /* borrows its arrays; those that the file does not keep are NULL. For a
                      local file its origin counts from that of the file. */
    cwi_turn turn; /* from its coordinates to those of the file */
    uint64_t first, first_normal, first_triangle; /* what the parts before it have */
    int digits;                                   /* that a place is written with in text */
    const uint32_t *numbers;                      /* of each vertex, for a writer's own use */
    size_t group;                                 /* likewise */
    size_t level;                                 /* of detail, as in cw_part */
    double max_error_mm, rms_error_mm;            /* the same */
    double time_s;                                /* the same */
    double from_s, until_s;                       /* in sight; from the animation's start */
    char name[CWI_NAME_BYTES];                    /* printable UTF-8 on one line */
} cwi_part;

/* Formats that hold one mesh write them one behind the other; all have the same arrays then. */
typedef struct cwi_parts {
    cwi_part *items;
    size_t count;
    uint64_t vertices, triangles; /* of all */
    double end_s;                 /* of the animation that shows them; 0: there is none */
} cwi_parts;

/* Takes bytes on their way into a file; to is its own. */
typedef cw_status cwi_drain(void *to, const void *bytes, size_t size, cw_error *err);

typedef struct cwi_mesh_output {
    cwi_outfile *file;
    cwi_drain *drain; /* where records go; NULL: to the file as they are */
    void *drain_to;
    const char *name;           /* of all parts together; as that of a part */
    const double *local_origin; /* what gives the world's coordinates when added, as the file
                                   counts them; NULL: nothing */
    const cw_write_desc *desc;
    const cw_axes *axes;
    bool text;
    const cw_progress *progress;
    size_t done, total; /* records, for progress; a writer sets the total */
} cwi_mesh_output;

typedef cw_status cwi_mesh_writer(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err);

cwi_mesh_writer cwi_stl_write;
cwi_mesh_writer cwi_ply_write;
cwi_mesh_writer cwi_obj_write;
cwi_mesh_writer cwi_off_write;
cwi_mesh_writer cwi_3mf_write;
cwi_mesh_writer cwi_vtp_write;
cwi_mesh_writer cwi_glb_write;
cwi_mesh_writer cwi_gltf_write;
cwi_mesh_writer cwi_drc_write;

/* As VTP with indices of 64 bits, which cwi_vtp_write() takes for meshes that need them. */
cwi_mesh_writer cwi_vtp_write_wide;

/* Loads the module that both glTF writers need. CW_ERR_UNSUPPORTED: not in this build. */
CW_NODISCARD cw_status cwi_gltf_prepare(cw_error *err);

/* Loads the module of the codec that is asked for, before there is anything to compress.
 * CW_ERR_ARGUMENT: it has not so many bits; CW_ERR_UNSUPPORTED. */
CW_NODISCARD cw_status cwi_gltf_prepare_codec(const cw_write_desc *desc, cw_error *err);

/* Puts record i of a part at to, where there is room for CWI_RECORD_BYTES; returns its end. */
typedef unsigned char *cwi_record_encoder(const cwi_part *part, size_t i, unsigned char *to);

/* Writes a part's records 0 to count - 1 and reports progress on the way. */
CW_NODISCARD cw_status cwi_write_records(const cwi_part *part, cwi_mesh_output *out,
                                         cwi_record_encoder *encode, size_t count,
                                         cw_error *err);

/* Writes a record for every vertex, or triangle, of all parts. */
CW_NODISCARD cw_status cwi_write_part_vertices(const cwi_parts *parts, cwi_mesh_output *out,
                                               cwi_record_encoder *encode, cw_error *err);
CW_NODISCARD cw_status cwi_write_triangles(const cwi_parts *parts, cwi_mesh_output *out,
                                           cwi_record_encoder *encode, cw_error *err);

enum { CWI_ORIGIN_BYTES = 160 };

/* The origin of a local file as text, between what stands before and after it: " from 1 2 3.5".
 * Empty for a file of world coordinates. */
void cwi_print_origin(const cwi_mesh_output *out, const char *before, const char *after,
                      char text[CWI_ORIGIN_BYTES]);

/* Adds what a part loses in a file that holds its coordinates in single precision. */
CW_NODISCARD cw_status cwi_measure_loss(const cwi_part *part, cw_write_loss *loss,
                                        cw_error *err);

/* The part's box in the file. */
void cwi_part_bounds(const cwi_part *part, double low[3], double high[3]);

/* CW_ERR_LIMIT when a coordinate is beyond single precision's largest number. */
CW_NODISCARD cw_status cwi_check_single(const cwi_parts *parts, cw_error *err);

/* As it stands in the file. Summed in double: a position keeps its micrometres until the format
 * takes them. */
static inline double cwi_file_coordinate(const cwi_part *part, size_t vertex, int axis)
{
    const int a = part->turn.from[axis];
    const double world =
        part->mesh.origin[a] + (double)part->mesh.positions[3 * vertex + (size_t)a];
    return cwi_turn_coordinate(&part->turn, axis, world);
}

static inline void cwi_normal(const cwi_part *part, size_t vertex, float normal[3])
{
    for (int a = 0; a < 3; a++)
        normal[a] = (float)part->turn.sign[a] *
                    part->mesh.normals[3 * vertex + (size_t)part->turn.from[a]];
}

/* A vertex's place and its normal as text: three numbers each. */
static inline unsigned char *cwi_put_place(unsigned char *to, const cwi_part *part, size_t v)
{
    double place[3];
    for (int a = 0; a < 3; a++)
        place[a] = cwi_file_coordinate(part, v, a);
    return cwi_put_decimals(to, place, part->digits);
}

static inline unsigned char *cwi_put_normal(unsigned char *to, const cwi_part *part, size_t v)
{
    float normal[3];
    cwi_normal(part, v, normal);
    return cwi_put_singles(to, normal);
}

/* A triangle's corner, counted through all parts from 0. */
static inline uint64_t cwi_corner_number(const cwi_part *part, size_t triangle, int corner)
{
    return part->first + part->mesh.triangles[3 * triangle + (size_t)corner];
}

/* "3 0 1 2": a face of PLY as text, and of OFF. */
static inline unsigned char *cwi_put_face_line(const cwi_part *part, size_t triangle,
                                               unsigned char *to)
{
    *to++ = '3';
    for (int c = 0; c < 3; c++)
        to = cwi_put_integer(cwi_put_text(to, " "), cwi_corner_number(part, triangle, c));
    return cwi_put_text(to, "\n");
}

#ifdef __cplusplus
}
#endif

#endif
