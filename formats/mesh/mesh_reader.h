/* The common parts of mesh readers: the file, its limits, and a mesh that grows while it is
 * read. */
#ifndef FORMATS_MESH_MESH_READER_H
#define FORMATS_MESH_MESH_READER_H

#include "formats/bytes/input_file.h"
#include "formats/mesh/face_polygons.h"
#include "formats/text/text_scanner.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The beginning of a part in the file. */
typedef struct cwi_mark {
    size_t triangle; /* its first triangle */
    size_t name;     /* start of its name among the names */
    bool labelled;   /* it is the surface of a label: that of this layer and value */
    uint32_t layer, value;
    uint32_t object;   /* marks of one object have one number */
    uint32_t textures; /* those of in->pictures, from 1 on; 0: none */
} cwi_mark;

typedef struct cwi_marks {
    cwi_mark *items;
    char *names; /* each ends with a zero */
    size_t count, capacity, name_bytes, name_capacity;
} cwi_marks;

/* A picture that was read. */
typedef struct cwi_picture {
    char *name; /* of its file or place, by which it is known */
    cw_texture file;
} cwi_picture;

/* The pictures of a file, and the sets of them that materials have. */
typedef struct cwi_pictures {
    bool is_wanted; /* else none are read */
    cwi_picture *items;
    cw_textures *sets;
    size_t count, capacity, set_count, set_capacity;
    bool is_missing; /* a picture's file is missing, unreadable, or outside of the folder */
} cwi_pictures;

/* An open file, and the limits of its mesh. */
typedef struct cwi_mesh_input {
    cwi_input file;
    cw_mesh_read_desc desc; /* defaults filled in */
    uint64_t bytes;         /* bytes of arrays so far */
    cwi_marks marks;
    cw_label_table labels; /* those of marks */
    cwi_pictures pictures; /* those of marks */
} cwi_mesh_input;

/* Fills a zeroed mesh and the facts that the file states (parts is 1 beforehand). Coordinates
 * stay as in the file, if said->axes tells their meaning. The caller turns them, frees the mesh
 * of a reader that failed, and puts the file's name in front of its message. */
typedef cw_status cwi_mesh_reader(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata,
                                  cw_error *err);

/* Returns true if a file with such a head has the format; size is at most CWI_SNIFF_BYTES. */
typedef bool cwi_mesh_sniffer(const unsigned char *head, size_t size, uint64_t file_size);

/* Makes an array (array is the address of its pointer) hold at least count elements of a size;
 * new elements are not initialised. room is its capacity.
 * Returns CW_ERR_LIMIT past desc.max_bytes, CW_ERR_NO_MEMORY; the array is then unchanged. */
CW_NODISCARD cw_status cwi_mesh_grow(cwi_mesh_input *in, void *array, size_t *capacity,
                                     size_t count, size_t size, cw_error *err);

/* Begins a part of that name ("": none) at a triangle. It replaces a part that has no
 * triangles.
 * Returns as cwi_mesh_grow() */
CW_NODISCARD cw_status cwi_mesh_begin_part(cwi_mesh_input *in, const char *name,
                                           size_t triangle, cw_error *err);

/* Goes on with the object of the last part, from a triangle on with these textures; 0: none.
 * Returns as cwi_mesh_grow() */
CW_NODISCARD cw_status cwi_mesh_begin_textures(cwi_mesh_input *in, uint32_t textures,
                                               size_t triangle, cw_error *err);

/* States the label of the part that was begun last: a copy.
 * Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_mesh_label_part(cwi_mesh_input *in, const cw_label *label,
                                           cw_error *err);

/* Counts memory that is used temporarily, until the caller subtracts it from in->bytes again.
 * Returns CW_ERR_LIMIT past desc.max_bytes; it is not counted then. */
CW_NODISCARD cw_status cwi_mesh_take_bytes(cwi_mesh_input *in, uint64_t bytes, cw_error *err);

/* Returns CW_ERR_LIMIT for more triangles than desc.max_triangles. */
CW_NODISCARD cw_status cwi_mesh_limit_triangles(const cwi_mesh_input *in, uint64_t count,
                                                cw_error *err);

/* Gives back the unused capacity of positions and triangles. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_mesh_shrink(cw_mesh *mesh, cw_error *err);

/* The points and faces read so far. Zero it, except for `in`. */
typedef struct cwi_mesh_build {
    cwi_mesh_input *in;  /* borrowed */
    double *points;      /* point_count x 3 */
    uint32_t *triangles; /* triangle_count x 3 */
    size_t point_count, point_capacity;
    size_t triangle_count, triangle_capacity;
    uint32_t first, last;       /* corners of the current face */
    size_t corners;             /* ... and their number so far */
    cwi_face_polygon *polygons; /* polygon_count of them */
    size_t polygon_count, polygon_capacity;
    int base; /* the number of the first vertex in the file, for messages */
} cwi_mesh_build;

/* Reserves room for that many points and triangles at once. */
CW_NODISCARD cw_status cwi_build_reserve(cwi_mesh_build *b, uint64_t points, uint64_t triangles,
                                         cw_error *err);
CW_NODISCARD cw_status cwi_build_point(cwi_mesh_build *b, const double point[3], cw_error *err);

/* Adds the next corner of a face, counted from 0; it may name a point that is still to come.
 * From the third on, each corner makes a triangle with the first and the previous one. */
CW_NODISCARD cw_status cwi_build_corner(cwi_mesh_build *b, int64_t point, cw_error *err);

/* Ends the face, and counts it if it is a polygon or is skipped. Returns as cwi_mesh_grow() */
CW_NODISCARD cw_status cwi_build_end_face(cwi_mesh_build *b, cw_mesh_file *metadata,
                                          cw_error *err);

/* Moves points and triangles into the mesh, cuts polygons for which a fan is wrong, and adds the origin chosen for them to its own.
 * Returns CW_ERR_FORMAT for a point that is not finite or an index that names no point. */
CW_NODISCARD cw_status cwi_build_finish(cwi_mesh_build *b, cw_mesh *mesh,
                                        cw_mesh_file *metadata, cw_error *err);
void cwi_build_free(cwi_mesh_build *b);

/* Adds something to the list of what a file has and a mesh has not, if the condition holds. */
void cwi_say_left_out(cw_mesh_file *metadata, bool is_there, const char *name);

/* Reads a comment that our writers leave in text files: "cubewright VERSION, LPS, mm", and
 * after it (*ours) "origin X Y Z" of a local file. */
void cwi_take_comment(const char *text, bool *ours, cw_mesh *mesh, cw_mesh_file *metadata);

/* Reads three numbers, for the origin in a line of our writers. Returns false, with the origin
 * unchanged, when they are missing or not finite. */
bool cwi_parse_origin(const char *text, double origin[3]);

#ifdef __cplusplus
}
#endif

#endif
