/* The common parts of mesh writers: parts, outputs, records, and coordinates in the file. */
#ifndef FORMATS_MESH_MESH_WRITER_H
#define FORMATS_MESH_MESH_WRITER_H

#include <cubewright/formats.h>

#include "core/files/atomic_file.h"
#include "core/files/atomic_folder.h"
#include "core/files/stored_file.h"
#include "formats/bytes/little_endian.h"
#include "formats/mesh/mesh_axes.h"
#include "formats/mesh/mesh_spool.h"
#include "formats/text/number_format.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_NAME_BYTES = 256, CWI_RECORD_BYTES = 512 };

/* A part as a writer receives it: checked, with triangles. */
typedef struct cwi_part {
    const cw_mesh_spool *spool; /* holds the arrays of the mesh; NULL: the mesh does */
    cw_mesh mesh;  /* borrows its arrays; those that the file does not keep are NULL. In a local
                      file its origin is relative to that of the file */
    cwi_turn turn; /* from its coordinates to those of the file */
    uint64_t first, first_normal, first_triangle; /* numbers of elements in the parts before
                                                     it */
    int digits;                                   /* number of digits of a coordinate in text */
    const uint32_t *sides;                        /* as in cw_write_desc */
    const cw_label_table *side_labels;            /* of sides; else NULL */
    const uint32_t *numbers;                      /* one per vertex, for a writer's own use */
    size_t group;                                 /* for a writer's own use */
    size_t level;                                 /* of detail, as in cw_part */
    double max_error_mm, rms_error_mm;            /* the same */
    double time_s;                                /* the same */
    double from_s, until_s;                       /* time in sight; from the animation's
                                                     start */
    const cw_label *label;                        /* as in cw_part */
    bool
        has_color; /* one colour for all of it, in a format of parts: the label's, or that of */
    uint8_t color[4]; /* all vertices; mesh.colors is then NULL */
    const uint8_t
        *face_colors; /* CW_FACE_COLORS: triangle_count x 4; NULL: none that the file keeps */
    const cw_attribute *texture; /* CW_TEXTURE_COORDINATES; NULL: none that the file keeps */
    const cw_attribute *corner_normals; /* CW_CORNER_NORMALS; NULL: none that the file keeps */
    const cw_textures *textures;        /* as in cw_part, where the file keeps it */
    const uint32_t
        *places; /* corners: numbers of their places at seams, for a writer's own use */
    uint64_t first_place; /* as first, of these numbers */
    unsigned arrays; /* that the file holds: those of the mesh and, in a file of one mesh, those
                        that the label stands for; cw_keeps flags */
    char name[CWI_NAME_BYTES]; /* printable UTF-8 on one line */
} cwi_part;

/* All parts of a file. Formats of one mesh write them one after the other; all then have the
 * same arrays. */
typedef struct cwi_parts {
    cwi_part *items;
    size_t count;
    uint64_t vertices, triangles; /* of all */
    double end_s;                 /* of the animation that shows them; 0: there is none */
} cwi_parts;

/* Takes bytes for a file; `to` is its own state. */
typedef cw_status cwi_drain(void *to, const void *bytes, size_t size, cw_error *err);

typedef struct cwi_mesh_output {
    cwi_outfile *file;
    cwi_byte_output bytes;  /* takes the bytes of the file; zeroed: none does */
    cwi_outfolder *folder;  /* in place of the file, for formats of many files */
    cwi_outfile *side;      /* a second file that a writer opens beside the path; NULL: none */
    cwi_outfile **pictures; /* more of them: picture_count, from cwi_realloc_array() */
    size_t picture_count;
    const char *path;
    cwi_drain *drain; /* receiver of records; NULL: the file itself */
    void *drain_to;
    const char *name;           /* name of all parts together; like that of a part */
    const double *local_origin; /* the origin that gives the world's coordinates when added, in
                                   the file's axes; NULL: none */
    const cw_write_desc *desc;
    const cw_axes *axes;
    bool text;
    bool shared; /* other processes write the records that are theirs */
    const cw_progress *progress;
    size_t done, total; /* records, for progress; a writer sets the total */
} cwi_mesh_output;

typedef cw_status cwi_mesh_writer(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err);

/* Puts record i of a part at `to`, with room for CWI_RECORD_BYTES; returns its end. */
typedef unsigned char *cwi_record_encoder(const cwi_part *part, size_t i, unsigned char *to);

/* Writes a record for every vertex, or triangle, of a part, and reports progress on the way. A
 * part from a spool is read piece by piece, and an encoder sees one piece. Only facets have
 * positions there. */
CW_NODISCARD cw_status cwi_write_records(const cwi_part *part, cwi_elements elements,
                                         cwi_mesh_output *out, cwi_record_encoder *encode,
                                         cw_error *err);

/* Writes the records of all parts. */
CW_NODISCARD cw_status cwi_write_part_vertices(const cwi_parts *parts, cwi_mesh_output *out,
                                               cwi_record_encoder *encode, cw_error *err);
CW_NODISCARD cw_status cwi_write_triangles(const cwi_parts *parts, cwi_mesh_output *out,
                                           cwi_record_encoder *encode, cw_error *err);
CW_NODISCARD cw_status cwi_write_facets(const cwi_parts *parts, cwi_mesh_output *out,
                                        cwi_record_encoder *encode, cw_error *err);

enum { CWI_ORIGIN_BYTES = 160 };

/* Prints the origin of a local file, between the texts before and after it: " from 1 2 3.5".
 * Empty for a file of world coordinates. */
void cwi_print_origin(const cwi_mesh_output *out, const char *before, const char *after,
                      char text[CWI_ORIGIN_BYTES]);

/* Adds the loss of a part in a file that holds its coordinates in single precision. */
CW_NODISCARD cw_status cwi_measure_loss(const cwi_part *part, cw_write_loss *loss,
                                        cw_error *err);

/* Computes the part's box in the file's coordinates. */
void cwi_part_bounds(const cwi_part *part, double low[3], double high[3]);

/* Returns CW_ERR_LIMIT when a coordinate is beyond single precision's maximum. */
CW_NODISCARD cw_status cwi_check_single(const cwi_parts *parts, cw_error *err);

/* Returns a coordinate of the file. It is summed in double: a position keeps its micrometres
 * until the format rounds it. */
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

/* Returns a vertex's colour, sRGB and alpha, or label, where part->arrays has them. */
static inline const uint8_t *cwi_vertex_color(const cwi_part *part, size_t v)
{
    return part->mesh.colors ? part->mesh.colors + 4 * v : part->label->color;
}

static inline uint32_t cwi_vertex_label(const cwi_part *part, size_t v)
{
    return part->mesh.labels ? part->mesh.labels[v] : part->label->value;
}

/* Puts a vertex's position, or its normal, as text: three numbers each. */
static inline unsigned char *cwi_put_place(unsigned char *to, const cwi_part *part, size_t v)
{
    double position[3];
    for (int a = 0; a < 3; a++)
        position[a] = cwi_file_coordinate(part, v, a);
    return cwi_put_decimals(to, position, part->digits);
}

static inline unsigned char *cwi_put_normal(unsigned char *to, const cwi_part *part, size_t v)
{
    float normal[3];
    cwi_normal(part, v, normal);
    return cwi_put_singles(to, normal);
}

/* Returns the index of a triangle's corner, counted through all parts from 0. */
static inline uint64_t cwi_corner_number(const cwi_part *part, size_t triangle, int corner)
{
    return part->first + part->mesh.triangles[3 * triangle + (size_t)corner];
}

/* Puts a face as text, for PLY and OFF: "3 0 1 2". */
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
