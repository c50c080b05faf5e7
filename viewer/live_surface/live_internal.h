/* Types and functions that the files of the live surface share. */
#ifndef VIEWER_LIVE_SURFACE_LIVE_INTERNAL_H
#define VIEWER_LIVE_SURFACE_LIVE_INTERNAL_H

#include "viewer/live_surface/live_surface.h"

/* Buffers by the bindings of the shaders (viewer/shaders/live_*.glsl). */
typedef enum cwi_live_buffer {
    CWI_LIVE_PARAMS,
    CWI_LIVE_TOTALS,
    CWI_LIVE_RANGES,
    CWI_LIVE_SLOTS,
    CWI_LIVE_ACTIVE,
    CWI_LIVE_RECORDS,
    CWI_LIVE_COUNTS,
    CWI_LIVE_BASES,
    CWI_LIVE_SUMS,
    CWI_LIVE_OPEN,
    CWI_LIVE_OPEN_FIRST,
    CWI_LIVE_VERTICES,
    CWI_LIVE_INDICES,
    CWI_LIVE_TABLES,
    CWI_LIVE_MISSING,
    CWI_LIVE_BUFFERS
} cwi_live_buffer;

/* Counters that shaders keep in CWI_LIVE_TOTALS, and where sizes of dispatches are. */
enum {
    CWI_LIVE_ACTIVE_COUNT,
    CWI_LIVE_OPEN_COUNT,
    CWI_LIVE_VERTEX_COUNT,
    CWI_LIVE_TRIANGLE_COUNT,
    CWI_LIVE_MISSING_COUNT,
    CWI_LIVE_GAPS,
    CWI_LIVE_LOWEST,
    CWI_LIVE_HIGHEST,
    CWI_LIVE_FOR_ACTIVE = 8,
    CWI_LIVE_FOR_SCAN = 12,
    CWI_LIVE_FOR_OPEN = 16,
    CWI_LIVE_FOR_MEND = 20,
    CWI_LIVE_TOTAL_WORDS = 32
};

/* Programs, in the order in which they run. */
typedef enum cwi_live_pass {
    CWI_LIVE_FIND_RANGES,
    CWI_LIVE_SUM_BLOCKS,
    CWI_LIVE_TOP_BLOCKS,
    CWI_LIVE_PLACE_BLOCKS,
    CWI_LIVE_COUNT,
    CWI_LIVE_SIZE_OPEN,
    CWI_LIVE_PLAN,
    CWI_LIVE_SUM_COUNTS,
    CWI_LIVE_TOP_COUNTS,
    CWI_LIVE_PLACE_COUNTS,
    CWI_LIVE_EMIT,
    CWI_LIVE_BUILD,
    CWI_LIVE_SIZE_MEND,
    CWI_LIVE_MEND,
    CWI_LIVE_PASSES
} cwi_live_pass;

/* Entries that a group of a scan sums, as in live_common.glsl. */
enum { CWI_LIVE_SCAN = 1024 };

/* The words of a block's record and the bytes of a vertex, as in the shaders. */
enum { CWI_LIVE_RECORD = 100, CWI_LIVE_VERTEX_BYTES = 24, CWI_LIVE_TRIANGLE_BYTES = 12 };

/* Vertices that get their normal from triangles; those beyond are drawn flat. */
enum { CWI_LIVE_MENDED = 1 << 16 };

/* The start of CWI_LIVE_PARAMS. */
typedef struct cwi_live_params {
    double numbers[32];
    float caps[32];
    int32_t facts[32];
} cwi_live_params;

/* Sizes of what this OpenGL holds. */
typedef struct cwi_live_capacity {
    size_t texture_edge, buffer_bytes;
} cwi_live_capacity;

struct cwi_live {
    bool is_set_up; /* for the volume: */
    cw_volume key;  /* resolved */
    cwi_live_capacity capacity;
    GLuint voxels; /* texture */
    GLuint programs[CWI_LIVE_PASSES];
    cw_type program_type;
    int finished; /* programs, from the first */
    GLuint buffers[CWI_LIVE_BUFFERS], array, times[4];
    size_t bytes[CWI_LIVE_BUFFERS];
    size_t counted_bytes; /* taken from the account of memory */
    size_t blocks[3], block_count, slots, open_cells;
    bool has_ranges, has_gaps, has_surface;
    int64_t range[2]; /* of all values, as the shaders compare them */
    double isovalue;  /* of the surface that is there */
    bool inside_is_low;
    size_t vertex_count, triangle_count;
    cwi_live_params params;
};

/* Uploads the voxels. */
CW_NODISCARD cw_status cwi_live_upload(cwi_live *live, cw_error *err);

/* Returns true if some value is inside and some is not; without, there is no surface. */
bool cwi_live_is_crossed(const cwi_live *live);

/* Starts to compile those that are missing, and waits for none. */
void cwi_live_start_programs(cwi_live *live);

/* Finishes the programs that were started: all, or those that need no wait. */
CW_NODISCARD cw_status cwi_live_finish_programs(cwi_live *live, bool waits, bool *ready,
                                                cw_error *err);

/* Fills the tables of cases for the shaders: 256 words, and 8 for each configuration. */
enum { CWI_LIVE_TABLE_WORDS = 256 + 8 * 656 };
void cwi_live_fill_tables(uint32_t words[CWI_LIVE_TABLE_WORDS]);

/* Fills the parameters for an isovalue. Returns CW_ERR_ARGUMENT for one that is not finite,
 * CW_ERR_UNSUPPORTED for one whose differences doubles do not hold. */
CW_NODISCARD cw_status cwi_live_fill_params(const cwi_live *live, const cw_live_surface *desc,
                                            cwi_live_params *params, cw_error *err);

/* Makes a buffer at least so large; its content is lost where it grows. CW_ERR_LIMIT,
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_live_need(cwi_live *live, cwi_live_buffer n, size_t bytes,
                                     cw_error *err);

/* Does the same, with room to grow in what is allocated. */
CW_NODISCARD cw_status cwi_live_ensure_capacity(cwi_live *live, cwi_live_buffer n, size_t bytes,
                                                cw_error *err);

/* Makes the buffers of listed blocks and open cells as large as live->slots and
 * live->open_cells. */
CW_NODISCARD cw_status cwi_live_fit_slots(cwi_live *live, cw_error *err);

/* Makes all buffers but those of the surface, and the vertex array. */
CW_NODISCARD cw_status cwi_live_make_buffers(cwi_live *live, cw_error *err);

/* Extracts the surface into the buffers. */
CW_NODISCARD cw_status cwi_live_extract(cwi_live *live, const cw_live_surface *desc,
                                        cwi_live_times *times, cw_error *err);

#endif
