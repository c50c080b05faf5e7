/* What the mesh readers share: the file, its limits, and a mesh that grows as it is read. */
#ifndef FORMATS_MESH_MESH_READER_H
#define FORMATS_MESH_MESH_READER_H

#include "formats/bytes/input_file.h"
#include "formats/text/text_scanner.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where a part of the file begins. */
typedef struct cwi_mark {
    size_t triangle; /* the first of it */
    size_t name;     /* where it starts among the names */
} cwi_mark;

typedef struct cwi_marks {
    cwi_mark *items;
    char *names; /* each ends with a zero */
    size_t count, room, name_bytes, name_room;
} cwi_marks;

/* An open file, and how much may be made of it. */
typedef struct cwi_mesh_input {
    cwi_input file;
    cw_mesh_read_desc desc; /* defaults filled in */
    uint64_t bytes;         /* of arrays so far */
    cwi_marks marks;
} cwi_mesh_input;

/* Fills a zeroed mesh and what the file says of itself (parts is 1 beforehand). Coordinates are
 * as they stand in the file, if said->axes tells what they are. The caller turns them, frees
 * the mesh of a reader that failed, and puts the file's name in front of its message. */
typedef cw_status cwi_mesh_reader(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *said,
                                  cw_error *err);

/* Whether a file that starts so is of the format; size is at most CWI_SNIFF_BYTES. */
typedef bool cwi_mesh_sniffer(const unsigned char *head, size_t size, uint64_t file_size);

/* The format of a mesh file that starts so, or has that extension; NULL: of none. */
const char *cwi_mesh_format_by_content(const unsigned char *head, size_t size,
                                       uint64_t file_size);
const char *cwi_mesh_format_by_extension(const char *path);

cwi_mesh_sniffer cwi_stl_sniff;
cwi_mesh_sniffer cwi_ply_sniff;
cwi_mesh_sniffer cwi_off_sniff;
cwi_mesh_sniffer cwi_glb_sniff;
cwi_mesh_sniffer cwi_gltf_sniff;
cwi_mesh_sniffer cwi_3mf_sniff;
cwi_mesh_sniffer cwi_vtp_sniff;
cwi_mesh_sniffer cwi_drc_sniff;

cwi_mesh_reader cwi_stl_read;
cwi_mesh_reader cwi_ply_read;
cwi_mesh_reader cwi_obj_read;
cwi_mesh_reader cwi_off_read;
cwi_mesh_reader cwi_glb_read;
cwi_mesh_reader cwi_gltf_read;
cwi_mesh_reader cwi_3mf_read;
cwi_mesh_reader cwi_vtp_read;
cwi_mesh_reader cwi_drc_read;

/* Makes an array (array is the address of its pointer) hold at least count elements of a size;
 * what is new is not initialised. room is how many it holds.
 * Returns CW_ERR_LIMIT past desc.max_bytes, CW_ERR_NO_MEMORY; the array is then as before. */
CW_NODISCARD cw_status cwi_mesh_grow(cwi_mesh_input *in, void *array, size_t *room,
                                     size_t count, size_t size, cw_error *err);

/* The triangles from this one on are of another part, of that name ("": none); it takes the
 * place of one that has no triangles. Returns as cwi_mesh_grow() */
CW_NODISCARD cw_status cwi_mesh_begin_part(cwi_mesh_input *in, const char *name,
                                           size_t triangle, cw_error *err);

/* Counts memory that is used for a while, until the caller takes it off in->bytes again.
 * Returns CW_ERR_LIMIT past desc.max_bytes; it is not counted then. */
CW_NODISCARD cw_status cwi_mesh_take_bytes(cwi_mesh_input *in, uint64_t bytes, cw_error *err);

/* CW_ERR_LIMIT for more triangles than desc.max_triangles. */
CW_NODISCARD cw_status cwi_mesh_limit_triangles(const cwi_mesh_input *in, uint64_t count,
                                                cw_error *err);

/* Gives back what positions and triangles have too much room for. CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_mesh_shrink(cw_mesh *mesh, cw_error *err);

/* Points and faces as they come. Zero it, but for `in`. */
typedef struct cwi_mesh_build {
    cwi_mesh_input *in;  /* borrowed */
    double *points;      /* point_count x 3 */
    uint32_t *triangles; /* triangle_count x 3 */
    size_t point_count, point_room;
    size_t triangle_count, triangle_room;
    uint32_t first, last; /* corners of the face that is being read */
    size_t corners;       /* ... and how many it has so far */
    int base;             /* the file's number of its first vertex, for messages */
} cwi_mesh_build;

/* Room for so many, in one piece. */
CW_NODISCARD cw_status cwi_build_reserve(cwi_mesh_build *b, uint64_t points, uint64_t triangles,
                                         cw_error *err);
CW_NODISCARD cw_status cwi_build_point(cwi_mesh_build *b, const double point[3], cw_error *err);

/* The next corner of a face, counted from 0; it may name a point that is yet to come. From the
 * third on each makes a triangle with the first and the one before. */
CW_NODISCARD cw_status cwi_build_corner(cwi_mesh_build *b, int64_t point, cw_error *err);

/* The face is over: a polygon or something to skip is counted. */
void cwi_build_end_face(cwi_mesh_build *b, cw_mesh_file *said);

/* Moves points and triangles into the mesh, adds the origin chosen for them to the one there.
 * Returns CW_ERR_FORMAT for a point that is not finite, an index that names none. */
CW_NODISCARD cw_status cwi_build_finish(cwi_mesh_build *b, cw_mesh *mesh, cw_error *err);
void cwi_build_free(cwi_mesh_build *b);

/* What our writers leave in a comment of text files: "cubewright VERSION, LPS, mm", and behind
 * that (*ours) "origin X Y Z" of a local file. */
void cwi_take_comment(const char *text, bool *ours, cw_mesh *mesh, cw_mesh_file *said);

/* Reads three numbers, for the origin that our writers leave in a line of text; false, and the
 * origin as it was, when they are not there or not finite. */
bool cwi_parse_origin(const char *text, double origin[3]);

#ifdef __cplusplus
}
#endif

#endif
