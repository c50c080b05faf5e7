/* The session of `cubewright view`: what is seen, how, and what people do to it. Whatever
 * changes it is a command in words, from a key, a widget, the mouse or a script alike. */
#ifndef CLI_SESSION_VIEW_H
#define CLI_SESSION_VIEW_H

#include "cli/render/camera_options.h"
#include "cli/render/compare_options.h"
#include "cli/render/render_run.h"
#include "viewer/window/ui.h"

#include <cubewright/extract.h>

#include <dirent.h>
#include <time.h>

/* Parts of the window that show a picture. */
typedef enum view_part_name {
    VIEW_SPACE, /* the scene, in any mode */
    VIEW_AXIAL,
    VIEW_CORONAL,
    VIEW_SAGITTAL,
    VIEW_PARTS
} view_part_name;
enum { VIEW_ALL = (1 << VIEW_PARTS) - 1, VIEW_SLICES = VIEW_ALL - (1 << VIEW_SPACE) };

/* How well a part is drawn. */
typedef enum view_level {
    VIEW_STALE,
    VIEW_ROUGH, /* smaller, with longer steps: while something moves */
    VIEW_FAIR,  /* in full size */
    VIEW_FINAL  /* as asked for */
} view_level;

typedef struct view_part {
    bool is_shown;
    cwi_ui_rect rect;
    view_level level;
    cw_scene scene; /* as it was drawn; what it points to may be gone */
    double scale;   /* of rough pictures */
    double ms;      /* that the last one took */
} view_part;

/* A value between points: of view.measure_points count from first on. */
typedef enum view_measure_kind {
    VIEW_MEASURE_NONE,
    VIEW_MEASURE_DISTANCE,
    VIEW_MEASURE_ANGLE,
    VIEW_MEASURE_AREA
} view_measure_kind;
typedef struct view_measure {
    view_measure_kind kind;
    size_t first, count;
} view_measure;
enum { VIEW_MEASURES = 64, VIEW_POLYGON = 128 };

/* State of a session that undo restores and that is saved. */
typedef struct view_state {
    render_args args;
    bool iso_is_ours; /* nobody asked for that isovalue, but for a mesh */
    bool is_edited;   /* the transfer function is curve, not that of args */
    cw_transfer curve;
    bool is_placed; /* the camera has been set */
    cw_camera camera;
    double cross[3];  /* in the world */
    double window[2]; /* values from black to white in slices; both 0: all */
    double slice_zoom;
    double left_fraction; /* of the left side of a comparison */
    size_t step;          /* of the series */
    view_measure measures[VIEW_MEASURES];
    size_t measure_count;
} view_state;

enum { VIEW_UNDO = 64, VIEW_MESSAGE = 1024, VIEW_BOOKMARKS = 64 };

/* Further things that the window shows; keys switch them. */
typedef struct view_shown {
    bool panels, help, handles, cross, playing, about, files, save_mesh, save_picture, gallery;
    int cut; /* axis that the wheel cuts along: 1 to 3; 0: none */
} view_shown;

enum { VIEW_PATH = 4096, VIEW_RECENT = 10 };

/* Facts on the surface as it would be saved. */
typedef struct view_mesh_facts {
    size_t triangles, vertices, open_edges;
    bool is_closed;
    bool has_error;         /* the distances are known: */
    double max_mm, rms_mm;  /* between the mesh and what it approximates */
    const char *error_from; /* "the field" or "the full surface" */
} view_mesh_facts;

/* Facts on the surface with at most that number of triangles. */
typedef struct view_measured_mesh {
    bool is_known;
    size_t triangles;
    double iso;
    view_mesh_facts facts;
} view_measured_mesh;

typedef struct view_history {
    view_state states[VIEW_UNDO];
    size_t count, at; /* states[at] is the one at hand */
    char verb[32];    /* of the last change */
    size_t gesture;   /* in which it was made */
    bool is_drag;     /* on a picture */
} view_history;

/* Cameras that the scene was seen from: cameras[at] is the one at hand. */
typedef struct view_cameras {
    cw_camera cameras[VIEW_UNDO];
    size_t count, at;
    char verb[32];  /* of the last movement */
    size_t gesture; /* in which it was made */
} view_cameras;

/* A view that was given a name. */
typedef struct view_bookmark {
    char name[32];
    cw_camera camera;
    char look[512]; /* commands: isovalue, cut, opacity */
} view_bookmark;

/* The surface at the isovalue; its mesh is that of the source. */
typedef struct view_surface {
    cw_extractor *extractor, *coarse;
    cw_volume thinned; /* what coarse extracts from */
    cw_mesh old_mesh;  /* was drawn until now: its address must not come again */
    bool is_drawn;     /* the renderer holds the mesh, and no longer the old one */
    double iso;
    int level;            /* 0: none, 1: of coarse, 2: of all */
    cw_live_surface live; /* as it was drawn last in place of the mesh */
    bool is_live;         /* it was, in the picture that is shown */
    bool refuses_live;    /* the GPU does not extract from this volume */
} view_surface;

/* The surface cut to pieces for a printer, as a picture: the mesh of the source is that of pieces pulled apart. */
typedef struct view_pieces {
    bool are_shown;
    cw_mesh whole;  /* the surface itself, until they are hidden */
    char *command;  /* that writes them; or NULL */
    char *settings; /* options of the command cut, as they were typed; or NULL */
} view_pieces;

/* Labels of a label map, or of an overlay. */
typedef struct view_label_map {
    char note[CLI_LABELS_TEXT]; /* why the volume is taken for a label map; "": it is not */
    cli_label_look look;        /* as it is drawn; labels: NULL for none */
    cli_label_look found;       /* that the scene is of */
    cli_label_scene scene;
    bool has_scene; /* and its surfaces: */
    bool has_mesh;
} view_label_map;

/* Another volume over that of the file. */
typedef struct view_overlay {
    const char *path; /* of the volume; NULL: labels are those of the file */
    cli_volume volume;
    bool looks_like_labels;
    bool has_range; /* the percentiles are known: */
    double range[2];
    cli_slice_labels values; /* where it is drawn as values; else volume is NULL */
} view_overlay;

/* The file that is open, and what was made of it. */
typedef struct view_document {
    char *path;   /* the first of files; NULL: nothing is open */
    char **files; /* a file or a folder, or the files of a series */
    size_t file_count;
    const char *opening; /* is being read; else NULL */
    cli_source source;
    bool has_volume;          /* that can be drawn */
    cw_statistics statistics; /* of the volume, over all its steps */
    double level;             /* between two classes of these values */
    double box[2][3];
    view_surface surface;
    view_pieces pieces;
    view_label_map labels;
    view_overlay overlay;
    view_measured_mesh measured; /* by measure-mesh */
} view_document;

/* How it is drawn, and what has been. */
typedef struct view_picture {
    cw_renderer *renderer;
    bool values_come; /* the volume's voxels are new to the renderer */
    cw_mode mode;
    cw_transfer transfer; /* what is drawn with */
    bool transfer_is_old;
    cw_transfer greys; /* of slices */
    bool is_saving;    /* what is drawn is for keeps: as render draws it */
    view_part parts[VIEW_PARTS];
    cw_comparison measured;
    bool is_measured;
    bool is_preliminary;              /* measured before the pictures were finished */
    bool is_alike;                    /* cli_compares_alike() */
    double mode_error[CW_MODE_COUNT]; /* rmse of 255, as measured; below 0: unknown */
    size_t thumbs;                    /* of presets that have been drawn */
} view_picture;

/* Sizes in pixels of the window, and of what the panels take of it. */
typedef struct view_sizes {
    size_t width, height;
    double bar_height, panel_width, strip_height; /* of menus, settings, status */
} view_sizes;

/* A note or an error to be read. */
typedef struct view_message {
    char text[VIEW_MESSAGE];
    bool is_error;
    double until; /* in ui seconds */
} view_message;

/* State of mouse and keys. */
typedef struct view_input {
    size_t gesture;   /* counts presses of buttons and keys */
    bool is_dragging; /* on a picture */
    bool is_monkey;   /* what comes in is random */
    size_t focus_at;  /* of the panels that are shown: the one whose widgets have the keys */
    char probe[256];  /* the value under the mouse, in words */
} view_input;

/* Commands on their way. */
typedef struct view_commands {
    char **words; /* texts that options point to */
    size_t word_count;
    bool is_queued; /* the command that runs comes from this list, not from a script: */
    char **queued;  /* commands to run after this frame */
    size_t queued_count;
    bool is_configuring;
    int depth; /* of files of commands that run others */
} view_commands;

typedef struct view_preview view_preview;

/* Bookmarks, and the film of them. */
typedef struct view_film {
    view_bookmark bookmarks[VIEW_BOOKMARKS];
    size_t bookmark_count;
    double seconds;        /* from bookmark to bookmark */
    bool is_running;       /* what runs is a film: it is not to be undone */
    view_preview *preview; /* the film that plays; NULL: none */
} view_film;

/* Points that were measured, and those that a tool is picking. */
typedef struct view_measuring {
    double (*points)[3]; /* of all measurements, also those that undo would restore */
    size_t point_count;
    view_measure_kind tool; /* that clicks measure with */
    double tool_points[VIEW_POLYGON][3];
    size_t tool_count;
} view_measuring;

/* Files that were opened before. */
typedef struct view_recent {
    char path[VIEW_PATH];     /* the file with the list; "": none is kept */
    char *files[VIEW_RECENT]; /* paths, the latest first */
    size_t count;
} view_recent;

typedef struct view_widgets view_widgets;
typedef struct view view;

struct view {
    const cli_command *command;
    const cwi_ui_functions *ui;
    cwi_ui *window;
    view_widgets *widgets; /* cli/window's: what its panels remember */
    /* Shows one frame: input, what it asks for, pictures. The window sets it. */
    cw_status (*show_frame)(view *v, double wait_s, cw_error *err);
    bool is_hidden, quits;

    view_document document;
    view_state state;
    view_history history;
    view_cameras cameras;
    view_picture picture;
    view_sizes layout;
    view_shown shown;
    view_message message;
    view_input input;
    view_commands script;
    view_film film;
    view_measuring measuring;
    view_recent recent;
};

/* view_session.c */
/* Several paths are the steps of a series. */
CW_NODISCARD cw_status view_open(view *v, const char *const *paths, size_t count,
                                 cw_error *err);
void view_close(view *v);
CW_NODISCARD cw_status view_go_to_step(view *v, size_t step, cw_error *err);
/* Returns the low and high corner of the clip box in mm, or of the whole scene without one. */
void view_clip_box(const view *v, double box[2][3]);
/* Values from black to white in slices. */
void view_grey_range(const view *v, double range[2]);
void view_touch(view *v, unsigned parts); /* marks parts to be drawn again */
bool view_draws_volume(const view *v);
/* Whether a mode draws what is open; slices need an even grid. */
bool view_fits_mode(const view *v, cw_mode mode);
bool view_has_mesh(const view *v);
double view_suggest_iso(const view *v);
CW_NODISCARD cw_status view_need_transfer(view *v, cw_error *err);
CW_NODISCARD cw_status view_place_camera(view *v, const char *name, cw_error *err);
CW_NODISCARD cw_status view_choose_mode(view *v,
                                        cw_error *err); /* after settings have changed */

/* view_labels.c: labels of label maps. */
void view_choose_labels(view *v); /* whether they are drawn */
/* Finds the labels that are drawn, and for a mesh makes their surfaces. */
CW_NODISCARD cw_status view_need_labels(view *v, cw_error *err);
CW_NODISCARD cw_status view_need_label_mesh(view *v, cw_error *err);
/* Finds if the volume that was read is a label map. */
CW_NODISCARD cw_status view_look_for_labels(view *v, cw_error *err);
void view_forget_labels(view *v); /* they are of another volume */
/* Names a label: "label 7, Liver". */
void view_name_label(const view *v, uint32_t value, char *text, size_t size);
/* The same of the label at a point of the world; "": none is drawn there. */
void view_label_at(const view *v, const double world[3], char *text, size_t size);
/* Returns the labels that are drawn over slices. */
cli_slice_labels view_slice_labels(const view *v);
bool view_shows_surfaces(const view *v); /* of labels */

/* verbs_pieces.c: shows the whole surface again, if pieces are shown. */
void view_hide_pieces(view *v);
/* Returns the surface itself, also while its pieces are shown. */
const cw_mesh *view_whole_mesh(const view *v);

/* view_history.c */
void view_remember(view *v, const char *verb);
void view_note_camera(view *v, const char *verb); /* for camera-back, after it has moved */
bool view_undo(view *v, int by);

/* view_settings.c */
const cli_option *view_find_option(const view *v, const char *name);
CW_NODISCARD cw_status view_parse_split(const view *v, cli_split *split, cw_error *err);
CW_NODISCARD cw_status view_set(view *v, const char *name, const char *value, cw_error *err);

/* view_state.c */
CW_NODISCARD cw_status view_write_state(const view *v, const char *path, cw_error *err);
char *view_command_line(const view *v); /* free() it */

/* view_commands.c, and verbs_*.c, which have the verbs */
typedef struct view_verb {
    const char *name, *takes, *about;
    int min_count, max_count; /* arguments */
    bool changes;             /* what undo brings back */
    cw_status (*run)(view *v, int count, char **args, cw_error *err);
} view_verb;
const view_verb *view_verb_at(size_t n); /* NULL after the last */
CW_NODISCARD cw_status view_run(view *v, int count, char **words, cw_error *err);

/* verbs_camera.c */
void view_put_bookmarks(const view *v, FILE *out, const char *end); /* as commands */

/* film.c: writes a film as pictures. The session is as before afterwards.
 * name     a text of key frames: seconds and commands a line; or "bookmarks"
 * pattern  of the pictures' names, with {frame}
 * Returns  CW_ERR_FORMAT naming the line, CW_ERR_LIMIT, CW_ERR_CANCELLED, or as the commands */
CW_NODISCARD cw_status view_make_film(view *v, const char *name, const char *pattern,
                                      double fps, cw_error *err);

/* Plays the bookmarks in the window, or stops; a frame shows the moment that has come. */
CW_NODISCARD cw_status view_start_preview(view *v, cw_error *err);
void view_stop_preview(view *v); /* and brings back what was before it */
void view_drop_preview(view *v); /* at the end */
CW_NODISCARD cw_status view_run_preview(view *v, cw_error *err);

/* verbs_scene.c: finds what a pixel of the scene shows; nothing where it is not drawn. */
CW_NODISCARD cw_status view_pick_point(view *v, const double pixel[2], cw_picked *picked,
                                       cw_error *err);

/* verbs_window.c: windows of Hounsfield units by name. NULL after the last; range: black, white */
const char *view_window_name(size_t n, double range[2]);
bool view_is_hounsfield(const view *v);

/* view_script.c: commands in a text, parted by ; or lines, words in quotes, # begins a comment. */
CW_NODISCARD cw_status view_exec(view *v, const char *text, cw_error *err);
CW_NODISCARD cw_status view_exec_file(view *v, const char *path, cw_error *err);
/* Reads a text of up to 1 MiB; free() it. Returns CW_ERR_IO, CW_ERR_FORMAT, naming the file */
CW_NODISCARD cw_status view_read_text(const char *path, char **text, cw_error *err);
void view_run_queued(view *v);

/* view_words.c */
const char *view_keep_text(view *v, const char *text);
void view_join_lines(char *text);
/* To be run after this frame; errors become messages. */
void view_ask(view *v, const char *format, ...) CW_PRINTF(2, 3);
void view_ask_open(view *v, const char *path); /* whatever is in its name */
void view_say(view *v, bool is_error, const char *text);

/* view_keys.c: what keys and menus do. */
typedef struct view_key {
    const char *command, *key, *menu; /* key, menu: NULL for none */
    const char *about;                /* NULL: that of the row before */
} view_key;
extern const view_key view_keys[];
extern const size_t view_key_count;
/* Something that is on or off: of view_shown, or a flag of the settings. false: no
 * such thing */
bool view_find_flag(const view *v, const char *name, bool *on);
bool *view_shown_flag(view *v, const char *name); /* NULL: none of those */
/* "X Y Z": the keys of a row and of those that have its about; false: none */
bool view_key_names(size_t n, char *names, size_t size);
void view_print_keys(FILE *out);

/* view_draw.c */
CW_NODISCARD cw_status view_draw(view *v, view_level level, bool may_stop, cw_error *err);
bool view_is_final(const view *v);
bool view_shows_isolines(const view *v); /* of the surface, on slices */
/* Draws one part into an image of the size of its rect. */
CW_NODISCARD cw_status view_draw_part(view *v, int part, view_level level, bool may_stop,
                                      cw_image *image, cw_error *err);
/* Returns the mode that a preset was made for: that at hand, or an intensity projection. */
cw_mode view_preset_mode(const view *v, const char *preset);
/* Draws the scene in the colours of a preset, small and quickly. */
CW_NODISCARD cw_status view_draw_preset(view *v, const char *preset, size_t width,
                                        size_t height, cw_image *image, cw_error *err);
/* Makes the surface at the isovalue, or of labels, in v->document.source.mesh. */
CW_NODISCARD cw_status view_need_surface(view *v, view_level level, cw_error *err);
/* Names what drew the surface: "gpu", "cpu", "cpu, coarse" or "none". */
const char *view_name_surface(const view *v);

/* view_pictures.c */
typedef enum view_layout {
    VIEW_LAYOUT_SHOWN, /* that of the window */
    VIEW_LAYOUT_SINGLE,
    VIEW_LAYOUT_QUAD
} view_layout;
typedef struct view_sheet {
    size_t width, height; /* 0: those of the window's pictures */
    view_layout layout;
} view_sheet;
/* Draws the session as asked for and writes it as a .png file. */
CW_NODISCARD cw_status view_write_picture(view *v, const view_sheet *sheet, const char *path,
                                          cw_error *err);

/* mesh_facts.c: the surface as it would be saved. */
/* Makes the surface that is shown, for view_whole_mesh(). Returns CW_ERR_ARGUMENT when none is, or it is empty */
CW_NODISCARD cw_status view_need_whole(view *v, cw_error *err);
/* Makes the mesh to save and measures it.
 * triangles   how many it has at most; 0: all of the surface
 * simplified  free it with cw_mesh_free()
 * mesh        set to simplified, or to the surface that is shown */
CW_NODISCARD cw_status view_make_mesh(view *v, size_t triangles, cw_mesh *simplified,
                                      const cw_mesh **mesh, view_mesh_facts *facts,
                                      cw_error *err);
void view_describe_mesh(const view_mesh_facts *facts, char *text, size_t size);

/* layout.c: places of the parts in the window. */
void view_lay_out(view *v);
void view_place_parts(view *v, const cwi_ui_rect *area, bool is_quad);
cwi_ui_rect view_picture_area(const view *v); /* of all parts, in the window */
bool view_is_quad(const view *v);

/* view_commands.c: frames of the window, for commands that need what they show. */
CW_NODISCARD cw_status view_frame(view *v, double wait_s, cw_error *err);
/* Frames until all that was fed has been taken in. */
CW_NODISCARD cw_status view_take_in(view *v, cw_error *err);
/* Frames until all is drawn as asked for. */
CW_NODISCARD cw_status view_settle(view *v, cw_error *err);

/* recent_files.c */
/* Reads the list of recent files: of that file, "none", or NULL for the user's. */
void view_start_recent(view *v, const char *named);
void view_end_recent(view *v);
void view_remember_file(view *v); /* that is open */

/* verbs_files.c: samples. */
bool view_has_sample(const char *name);
/* Opens the head MRI of Debian ("head"), or a field by its name, made when it is not there. */
CW_NODISCARD cw_status view_open_sample(view *v, const char *name, cw_error *err);

/* verbs_files.c: lists a folder in natural order and returns the number of entries; below 0: it
 * cannot be read. */
int view_scan(const char *folder, struct dirent ***entries);
void view_free_scan(struct dirent **entries, int count);

#endif
