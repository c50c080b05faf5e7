/* Reading of spools: pieces of a surface that is in temporary files. */
#ifndef FORMATS_MESH_MESH_SPOOL_H
#define FORMATS_MESH_MESH_SPOOL_H

#include <cubewright/spool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_SPOOL_POSITIONS, CWI_SPOOL_NORMALS, CWI_SPOOL_TRIANGLES, CWI_SPOOL_FILES };

/* Each array has three numbers of four bytes for an element. */
enum { CWI_SPOOL_ELEMENT = 12 };

/* The part of a surface that one process made. Its triangles count vertices from its first. */
typedef struct cwi_spool_segment {
    int files[CWI_SPOOL_FILES];
    size_t first_vertex, vertices, first_triangle, triangles;
} cwi_spool_segment;

struct cw_mesh_spool {
    cwi_spool_segment mine,
        *segments;             /* of all processes; mine alone while there are no others */
    size_t segment_count, own; /* own: number of mine */
    const cw_team *team;       /* that shares the surface; NULL: none */
    char *folder;
    bool has_normals;
    cw_mesh frame;
    double low[3], high[3]; /* of the positions */
};

/* Reads or writes `count` elements of an array's file. folder: of the file, for messages */
CW_NODISCARD cw_status cwi_read_elements(int file, size_t first, size_t count, void *to,
                                         cw_error *err);
CW_NODISCARD cw_status cwi_write_elements(const char *folder, int file, size_t first,
                                          const void *from, size_t count, cw_error *err);

/* Reads elements of an array of the whole surface. Triangles name vertices by their numbers in it. */
CW_NODISCARD cw_status cwi_spool_read(const cw_mesh_spool *spool, int array, size_t first,
                                      size_t count, void *to, cw_error *err);

/* The arrays that a spool has: cw_keeps flags. */
unsigned cwi_spool_arrays(const cw_mesh_spool *spool);

/* Returns the range of the positions of a spool with vertices. */
void cwi_spool_range(const cw_mesh_spool *spool, double low[3], double high[3]);

/* Returns the folder of a spool's temporary files. */
const char *cwi_spool_folder(const cw_mesh_spool *spool);

/* Elements of a piece; the last one may have fewer. */
enum { CWI_SPOOL_PIECE = 16384 };

/* The elements of a mesh that a piece has. Facets are triangles with corners of their own: their
 * vertices are those of the piece, three for each. */
typedef enum cwi_elements { CWI_VERTICES, CWI_TRIANGLES, CWI_FACETS } cwi_elements;

/* A reader of pieces, one after the other. A zeroed one is closed. */
typedef struct cwi_spool_reader {
    const cw_mesh_spool *spool;
    cwi_elements elements;
    size_t first, count; /* of the piece */
    size_t end;          /* of the elements that are read */
    bool is_part;        /* triangles may name vertices of the next part */
    cw_mesh mesh;        /* the piece's arrays; those that it lacks are NULL */
    struct cwi_block_cache *cache;
} cwi_spool_reader;

CW_NODISCARD cw_status cwi_spool_open(cwi_spool_reader *r, const cw_mesh_spool *spool,
                                      cwi_elements elements, cw_error *err);

/* Reads the elements of this process alone, of a spool that a team shares. */
void cwi_spool_read_own(cwi_spool_reader *r);

/* Reads the next piece; count is 0 behind the last one.
 * Returns CW_ERR_FORMAT for a triangle that names no vertex; CW_ERR_IO, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_spool_next(cwi_spool_reader *r, cw_error *err);
void cwi_spool_close(cwi_spool_reader *r);

#ifdef __cplusplus
}
#endif

#endif
