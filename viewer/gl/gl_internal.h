/* Types and functions that the files of the GL module share: the context, the data uploaded to
 * it, and the modes. */
#ifndef VIEWER_GL_GL_INTERNAL_H
#define VIEWER_GL_GL_INTERNAL_H

#include "viewer/gl/gl.h"
#include "viewer/gl/gl_context.h"
#include "viewer/scene/block_ranges.h"
#include "viewer/scene/transfer_table.h"

/* Texture units that are the same for every shader. */
enum {
    CWI_UNIT_VOLUME,
    CWI_UNIT_TABLE,    /* cwi_table, CWI_TABLE_ROWS x 1 */
    CWI_UNIT_SEGMENTS, /* pre-integrated */
    CWI_UNIT_SKIP,     /* blocks: how many blocks away the next visible one is */
    CWI_UNIT_DEPTH,    /* of the mesh */
    CWI_UNIT_GRADIENT,
    CWI_UNIT_FACTOR, /* of the extinction, by the gradient's length */
    CWI_UNIT_FREE    /* and those after it: a mode's own */
};

/* Format of texels, and their relation to voxels. */
typedef struct cwi_gl_texels {
    GLenum inner, type;
    size_t size;
    bool as_is;         /* voxels of this type are texels when they are packed */
    double scale, bias; /* voxel = texel (as shaders see it) x scale + bias */
} cwi_gl_texels;

/* A part of the volume that fits a texture: neighbours have a layer of samples in common. */
typedef struct cwi_gl_brick {
    size_t first[3], count[3];
    GLuint values, gradients; /* 0 until they are needed; gradients with shadows */
    GLuint voxels, buffer;    /* the caller's memory as a texture; 0 until it is needed */
} cwi_gl_brick;

/* A volume on the GPU. The number in a texel times scale plus bias is the scaled value. */
typedef struct cwi_gl_volume {
    cw_volume key; /* the view that was uploaded */
    size_t edge;   /* as the scene had it */
    cwi_gl_texels kind;
    double scale, bias;
    double range;                            /* of the scaled values, above 0 */
    size_t gradient_version, shadow_version; /* of the frame, when gradients were made */
    double gradient_unit; /* of gradients in textures: halves have few exponents */
    size_t brick_count;
    size_t texture_bytes; /* counted as taken */
    cwi_gl_brick *bricks;
    cwi_ranges ranges;
    bool in_place; /* shaders read voxels, not values */
} cwi_gl_volume;

/* The transfer function on the GPU. */
typedef struct cwi_gl_transfer {
    cw_transfer key;
    double opacity_units, surface, gradient_unit;
    bool is_made;
    cwi_table table;
    GLuint rows, skip, segments, factor;
    size_t segment_rows;   /* a side of segments */
    uint8_t *away;         /* the content of skip */
    double segment_length; /* of the content of segments; 0: nothing */
    double factor_end;     /* gradient per unit of eye space at the end of factor */
} cwi_gl_transfer;

enum { CWI_FACTOR_ROWS = 1024, CWI_GL_PROGRAMS = 64 };

/* Target of drawing: RGBA and depth textures of the picture's size. */
typedef struct cwi_gl_target {
    GLuint framebuffer, color, depth;
    GLuint rays; /* the same color without depth, which shaders may then read */
    GLsizei width, height;
} cwi_gl_target;

/* State of progress reports while a picture is drawn. */
typedef struct cwi_gl_watch {
    cw_progress progress; /* report: NULL when the scene has none */
    bool is_astray;       /* the context could not be made current again after a report */
    double last;          /* when the last report was, in seconds */
    double from, to;      /* fractions of the picture: of the part that is being drawn */
    size_t rows, layer_rows, triangles; /* to draw before the next report */
} cwi_gl_watch;

typedef struct cwi_gl_program {
    const char *vertex, *fragment; /* addresses of the sources */
    char defines[320];             /* the volume's before the mode's */
    GLuint name;
} cwi_gl_program;

struct cwi_gl {
    cwi_gl_context context;
    char name[256];
    const cwi_frame *frame; /* that is being drawn */
    cwi_gl_watch watch;
    GLuint frame_block, empty_array;
    cwi_gl_target target;
    cwi_gl_volume volume;
    cwi_gl_transfer transfer;
    size_t program_count;
    cwi_gl_program programs[CWI_GL_PROGRAMS];
    void *state[CW_MODE_COUNT]; /* each mode's own */
    struct cwi_live *live;      /* extracts live surfaces; NULL until one is drawn */
    void (*drop_states)(cwi_gl *gl);
};

/* Makes the context this thread's, until cwi_gl_leave() restores the previous one. Returns
 * false when it was lost. */
static inline bool cwi_gl_enter(cwi_gl *gl)
{
    return cwi_gl_context_enter(&gl->context);
}
static inline void cwi_gl_leave(cwi_gl *gl)
{
    cwi_gl_context_leave(&gl->context);
}

/* Starts asking the frame's progress again. */
void cwi_gl_start_watch(cwi_gl *gl);

/* Frees the data made from a volume, a mesh and a transfer function. */
void cwi_gl_drop_scene(cwi_gl *gl);

/* A program of two of the sources in shaders/ (cwi_glsl_NAME), each after common.glsl; made
 * once. The uniform block Frame and the texture units above are set.
 *
 * defines  "#define A 1\n...", at most 255 characters; "" for none
 * Returns  CW_ERR_BACKEND with GL's words */
CW_NODISCARD cw_status cwi_gl_use(cwi_gl *gl, const char *vertex, const char *fragment,
                                  const char *defines, GLuint *program, cw_error *err);
void cwi_gl_set(GLuint program, const char *name, float value);
void cwi_gl_set3(GLuint program, const char *name, const double value[3]);
extern const char cwi_glsl_common[], cwi_glsl_screen[];

/* Returns the definitions of shaders that go along rays. Unused code is not compiled, as
 * machines may run through it all the same. */
const char *cwi_gl_ray_defines(const cw_scene *scene);

/* Draws a triangle over the whole picture. */
void cwi_gl_draw_screen(cwi_gl *gl);

/* Reports progress: waits for drawing to finish, restores the caller's context for the report,
 * and takes the own one back. CW_ERR_CANCELLED; GL's state stays, except for the framebuffer's
 * scissor. */
CW_NODISCARD cw_status cwi_gl_report(cwi_gl *gl, const char *step, double done, cw_error *err);
/* Does the same, when the last report was some milliseconds ago: for loops of the CPU. */
CW_NODISCARD cw_status cwi_gl_report_soon(cwi_gl *gl, const char *step, double done,
                                          cw_error *err);
/* Announces that the n-th part of count of the picture is drawn next. */
void cwi_gl_part(cwi_gl *gl, size_t n, size_t count);

/* Draw long work, and report in between: the whole picture, for fragment shaders that go along
 * rays; drawing that keeps to the scissor, in bands; triangles of the bound mesh, by their
 * indices or one after another. CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_gl_draw_rays(cwi_gl *gl, cw_error *err);
CW_NODISCARD cw_status cwi_gl_draw_layer(cwi_gl *gl, void (*draw)(void *context), void *context,
                                         cw_error *err);
CW_NODISCARD cw_status cwi_gl_draw_triangles(cwi_gl *gl, size_t count, bool indexed,
                                             cw_error *err);

/* Prepares the frame's volume for shaders. It is read in place, if no textures are wanted and
 * the renderer can read it there; else it is uploaded. A volume that is there already stays. */
CW_NODISCARD cw_status cwi_gl_take_volume(cwi_gl *gl, bool as_textures, cw_error *err);
/* Returns true if shaders can read the only brick's voxels in the caller's memory: the
 * processor draws, and the voxels are of a type that it fetches, without gaps. Then there is no
 * upload, and no memory for another volume. */
bool cwi_gl_find_voxels(cwi_gl *gl);
/* Returns true if voxels lie x fastest, without gaps. */
bool cwi_gl_is_packed(const cw_volume *volume);
/* Finds the definitions that shaders need to compute gradients. Gradients of a small volume
 * become a texture. Those of a large one, which would then be five times as large, are
 * differences of interpolated values. */
CW_NODISCARD cw_status cwi_gl_need_gradients(cwi_gl *gl, const char **defines, cw_error *err);
void cwi_gl_drop_volume(cwi_gl *gl);

/* Binds a brick's textures and sets the uniforms brick_first and brick_size of a program. */
void cwi_gl_bind_brick(GLuint program, const cwi_gl_brick *brick);

/* Sets the uniform last_block for a texture of dim[0] x dim[1] x dim[2] blocks. */
void cwi_gl_set_last_block(GLuint program, const size_t dim[3]);

/* Returns the numbers of the bricks from the farthest to the nearest; free with cwi_free(). */
size_t *cwi_gl_order_bricks(const cwi_gl *gl);

/* Uploads the frame's transfer function, unless it is there, and binds it. */
CW_NODISCARD cw_status cwi_gl_take_transfer(cwi_gl *gl, cw_error *err);
/* Uploads, in addition, which blocks it leaves empty: the texture skip, and away. */
CW_NODISCARD cw_status cwi_gl_need_skip(cwi_gl *gl, cw_error *err);
/* Uploads it, in addition, pre-integrated for segments of a length in units of eye space. */
CW_NODISCARD cw_status cwi_gl_need_segments(cwi_gl *gl, double length, cw_error *err);
void cwi_gl_drop_transfer(cwi_gl *gl);

CW_NODISCARD cw_status cwi_gl_take_target(cwi_gl *gl, cw_error *err);
void cwi_gl_drop_target(cwi_gl *gl);

/* Makes a texture without mipmaps, linear or nearest, clamped to its edge, bound to a unit. */
GLuint cwi_gl_texture(GLenum kind, int unit, bool linear);

#endif
