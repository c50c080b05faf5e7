/* The options that say how to read a volume, and the reading itself: for every command that
 * takes one. */
#ifndef CLI_INPUTS_VOLUME_INPUT_H
#define CLI_INPUTS_VOLUME_INPUT_H

#include "cli/framework/json_writer.h"
#include "cli/framework/options.h"
#include "cli/inputs/filter_options.h"

#include <cubewright/formats.h>

/* Claims of the options about a file's coordinates; the first choice of each claims nothing. */
typedef struct cli_claim {
    int unit, up, frame;
    bool override;
} cli_claim;

/* Rows for the claims about the input or, with another prefix, about another file. */
#define CLI_CLAIM_OPTIONS(prefix, what, row)                                                   \
    {prefix "-unit",                                                                           \
     0,                                                                                        \
     CLI_CHOICE,                                                                               \
     "file/mm/um/cm/m/in/ft",                                                                  \
     "Unit of the coordinates, if " what " names none (as the file says, else mm)",            \
     row + offsetof(cli_claim, unit)},                                                         \
        {prefix "-up",                                                                         \
         0,                                                                                    \
         CLI_CHOICE,                                                                           \
         "file/z/y",                                                                           \
         "Axis that points up, if " what " does not say (z)",                                  \
         row + offsetof(cli_claim, up)},                                                       \
        {prefix "-frame",                                                                      \
         0,                                                                                    \
         CLI_CHOICE,                                                                           \
         "file/lps/ras",                                                                       \
         "Directions of x and y, if " what " does not say: LPS or RAS (lps)",                  \
         row + offsetof(cli_claim, frame)},                                                    \
    {                                                                                          \
        prefix "-override", 0, CLI_FLAG, NULL,                                                 \
            "Apply these three even where " what " says otherwise (off: that is an error)",    \
            row + offsetof(cli_claim, override)                                                \
    }

/* Choices of --stream: voxels are read slice by slice if they do not fit memory, always, never. */
enum { CLI_STREAM_AUTO, CLI_STREAM_ALWAYS, CLI_STREAM_NEVER };

/* The least --memory that counts the program too; less is a limit to voxels and surface. */
enum { CLI_MIN_MEMORY = 32 << 20 };

typedef struct cli_input {
    const char *reader, *raw, *series, *points;
    cli_array array;
    int gaps, tilt; /* cw_gaps, cw_tilt */
    bool skip_damaged;
    cli_number nodata;
    bool no_sandbox;
    size_t timeout_s;
    cli_lengths spacing;
    cli_claim claim;        /* of the input */
    cli_claim source_claim; /* of the source volume, in commands that take a mesh and that */
    cli_ranges crop;
    cli_resample resample;
    cli_denoise denoise;
    bool remove_table;
    const char *mask;
    cli_length mask_open, mask_close;
    bool makes_surface; /* the command calls cli_prepare_inside() */
    size_t level;       /* of an image in several sizes */
    size_t step;
    bool step_chosen; /* by the command, of a series: nothing is to be said of it */
    size_t threads, memory, max_voxels, max_triangles;
    bool allow_external, preview, truncated;
    size_t coarsen;    /* 0: 4 for a preview, else 1 */
    bool coarsen_view; /* all voxels are read, and only the view is coarse */
    bool is_quiet;     /* prints no lines about the file */
    int stream;        /* CLI_STREAM_... */
    bool may_stream;   /* the command can do with slices */
    bool of_labels;    /* values are numbers of labels: see cli_volume's ids */
    bool round_labels; /* those that are not whole are rounded */
    bool sample;       /* of many voxels some rows and slices are read: cli_volume's coarsen */
} cli_input;

/* Rows for a command whose struct has the field `input`. */
#define CLI_INPUT_ROW(args, field) offsetof(args, input) + offsetof(cli_input, field)
/* Rows that readers of volumes and of meshes share. */
#define CLI_SANDBOX_OPTION(args)                                                               \
    {                                                                                          \
        "no-sandbox", 0, CLI_FLAG, NULL,                                                       \
            "Let libraries read in this process, not in a sandboxed one (off)",                \
            CLI_INPUT_ROW(args, no_sandbox)                                                    \
    }
#define CLI_TIME_OPTIONS(args)                                                                 \
    {"timeout",                                                                                \
     0,                                                                                        \
     CLI_COUNT,                                                                                \
     "SECONDS",                                                                                \
     "Time limit of a library for one file (60)",                                              \
     CLI_INPUT_ROW(args, timeout_s)},                                                          \
    {                                                                                          \
        "threads", 't', CLI_COUNT, "N",                                                        \
            "Number of threads; results do not depend on it (0: all)",                         \
            CLI_INPUT_ROW(args, threads)                                                       \
    }
#define CLI_MEMORY_OPTION(args)                                                                \
    {                                                                                          \
        "memory", 0, CLI_BYTES, "SIZE",                                                        \
            "Memory limit of the program, checks included, such as 8G (75 % of the "           \
            "machine's)",                                                                      \
            CLI_INPUT_ROW(args, memory)                                                        \
    }

#define CLI_PREPARING_OPTIONS(args)                                                            \
    CLI_HEADED(CLI_PREPARING),                                                                 \
        {"resample",                                                                           \
         0,                                                                                    \
         CLI_RESAMPLE,                                                                         \
         "iso|L[:KERNEL]",                                                                     \
         "Sample the volume at other distances: iso, 0.5mm, 1x1x2mm; by linear, cubic or "     \
         "lanczos, such as iso:cubic; labels by majority or nearest (off; linear, majority)",  \
         CLI_INPUT_ROW(args, resample)},                                                       \
        {"denoise",                                                                            \
         0,                                                                                    \
         CLI_DENOISE,                                                                          \
         "FILTER",                                                                             \
         "Take noise out: gauss:L, median:N, and filters that keep edges: aniso[:STEPS[:K]], " \
         "nlm[:NOISE], bilateral:L[:V]; L such as 0.7vox or 0.5mm (off)",                      \
         CLI_INPUT_ROW(args, denoise)},                                                        \
    {                                                                                          \
        "remove-table", 0, CLI_FLAG, NULL,                                                     \
            "Make air of the table of a CT, and of all else beside the body (off)",            \
            CLI_INPUT_ROW(args, remove_table)                                                  \
    }

/* Rows for a command that makes a surface: they change what is inside, with cli_prepare_inside(). */
#define CLI_INSIDE_OPTIONS(args)                                                               \
    {"mask",                                                                                   \
     0,                                                                                        \
     CLI_TEXT,                                                                                 \
     "FILE",                                                                                   \
     "Leave out what is outside of a mask: a volume that is 0 there, in any grid (none)",      \
     CLI_INPUT_ROW(args, mask),                                                                \
     CLI_VALUES_FILE},                                                                         \
        {"mask-open",                                                                          \
         0,                                                                                    \
         CLI_VOXEL_LENGTH,                                                                     \
         "L",                                                                                  \
         "Remove what is thinner than a ball of this radius: 1vox, 0.5mm (off)",               \
         CLI_INPUT_ROW(args, mask_open)},                                                      \
    {                                                                                          \
        "mask-close", 0, CLI_VOXEL_LENGTH, "L",                                                \
            "Fill cracks and pores thinner than a ball of this radius: 1vox, 0.5mm (off)",     \
            CLI_INPUT_ROW(args, mask_close)                                                    \
    }

#define CLI_READING_OPTIONS(args)                                                                        \
    CLI_HEADED(CLI_READING),                                                                             \
        {"reader",                                                                                       \
         0,                                                                                              \
         CLI_TEXT,                                                                                       \
         "NAME",                                                                                         \
         "Read the file as this format; names as in 'formats' (by content)",                             \
         CLI_INPUT_ROW(args, reader),                                                                    \
         CLI_VALUES_READER},                                                                             \
        {"raw",                                                                                          \
         0,                                                                                              \
         CLI_TEXT,                                                                                       \
         "LAYOUT",                                                                                       \
         "Layout of headerless voxels: dims=64x64x93,type=u16le,offset=0,spacing=1x1x2mm",               \
         CLI_INPUT_ROW(args, raw)},                                                                      \
        {"spacing",                                                                                      \
         0,                                                                                              \
         CLI_LENGTHS,                                                                                    \
         "X[,Y,Z]",                                                                                      \
         "Distance between voxels, such as 0.5mm or 1x1x2mm (the file's)",                               \
         CLI_INPUT_ROW(args, spacing)},                                                                  \
        CLI_CLAIM_OPTIONS("input", "the input", CLI_INPUT_ROW(args, claim)),                             \
        {"series",                                                                                       \
         0,                                                                                              \
         CLI_TEXT,                                                                                       \
         "N",                                                                                            \
         "DICOM series of a folder: its number in 'info', or its UID (the only one)",                    \
         CLI_INPUT_ROW(args, series)},                                                                   \
        {"array",                                                                                        \
         0,                                                                                              \
         CLI_ARRAY,                                                                                      \
         "NAME[:N|:mag]",                                                                                \
         "Array to read, of files with several, and its --component, such as velocity:mag "              \
         "(the file's choice, else the first with one value)",                                           \
         CLI_INPUT_ROW(args, array)},                                                                    \
        {"grid",                                                                                         \
         0,                                                                                              \
         CLI_ARRAY,                                                                                      \
         "NAME[:N|:mag]",                                                                                \
         "OpenVDB grid to read (the first level set, else the first with one value)",                    \
         CLI_INPUT_ROW(args, array)},                                                                    \
        {"level",                                                                                        \
         0,                                                                                              \
         CLI_COUNT,                                                                                      \
         "N",                                                                                            \
         "Level of an image in several sizes (OME-Zarr, N5, Neuroglancer), counted from the finest (0)", \
         CLI_INPUT_ROW(args, level)},                                                                    \
        {"points",                                                                                       \
         0,                                                                                              \
         CLI_TEXT,                                                                                       \
         "FILE",                                                                                         \
         "File with the grid points of a PLOT3D solution",                                               \
         CLI_INPUT_ROW(args, points),                                                                    \
         CLI_VALUES_FILE},                                                                               \
        {"gaps",                                                                                         \
         0,                                                                                              \
         CLI_CHOICE,                                                                                     \
         "stop/interpolate/allow",                                                                       \
         "What to do where slices are missing or uneven (stop)",                                         \
         CLI_INPUT_ROW(args, gaps)},                                                                     \
        {"skip-damaged",                                                                                 \
         0,                                                                                              \
         CLI_FLAG,                                                                                       \
         NULL,                                                                                           \
         "Leave out slices whose files are damaged; what they leave are gaps (off)",                     \
         CLI_INPUT_ROW(args, skip_damaged)},                                                             \
        {"nodata",                                                                                       \
         0,                                                                                              \
         CLI_NUMBER,                                                                                     \
         "none/V",                                                                                       \
         "Value of voxels that have none, such as -1000; none: all have one (the file's)",               \
         CLI_INPUT_ROW(args, nodata)},                                                                   \
        {"tilt",                                                                                         \
         0,                                                                                              \
         CLI_CHOICE,                                                                                     \
         "correct/keep",                                                                                 \
         "Place slices of a tilted gantry where they were, or straight above each other "                \
         "(correct)",                                                                                    \
         CLI_INPUT_ROW(args, tilt)},                                                                     \
        {"crop",                                                                                         \
         0,                                                                                              \
         CLI_CROP,                                                                                       \
         "X:X,Y:Y,Z:Z",                                                                                  \
         "Read only these voxels, ends included; with units, those in a box of LPS mm (all)",            \
         CLI_INPUT_ROW(args, crop)},                                                                     \
        {"component",                                                                                    \
         0,                                                                                              \
         CLI_COMPONENT,                                                                                  \
         "N/mag",                                                                                        \
         "Component of voxels with several values; mag is the length of their vector (0)",               \
         CLI_INPUT_ROW(args, array.component)},                                                          \
        {"step",                                                                                         \
         0,                                                                                              \
         CLI_COUNT,                                                                                      \
         "N",                                                                                            \
         "Time step to read, counted from 0 (0)",                                                        \
         CLI_INPUT_ROW(args, step)},                                                                     \
        {"allow-external",                                                                               \
         0,                                                                                              \
         CLI_FLAG,                                                                                       \
         NULL,                                                                                           \
         "Follow headers to files outside their folder, and links in a folder (off)",                    \
         CLI_INPUT_ROW(args, allow_external)},                                                           \
        CLI_SANDBOX_OPTION(args), CLI_HEADED(CLI_LIMITS), CLI_TIME_OPTIONS(args),                        \
        {"max-voxels",                                                                                   \
         0,                                                                                              \
         CLI_COUNT,                                                                                      \
         "N",                                                                                            \
         "Stop before reading more voxels than this, such as 500M (2^40)",                               \
         CLI_INPUT_ROW(args, max_voxels)},                                                               \
        CLI_MEMORY_OPTION(args)

#define CLI_INPUT_OPTIONS(args) CLI_PREPARING_OPTIONS(args), CLI_READING_OPTIONS(args)

enum { CLI_MAX_NOTES = 8, CLI_MAX_CHANGES = 4 };

/* A change to the voxels that were read, by its option. */
typedef struct cli_change {
    const char *name;
    double seconds;
} cli_change;

/* Facts of an irregular grid: the number of cells of each shape and, once it was read, the
 * box of its points. */
typedef struct cli_grid {
    size_t cells[CW_SHAPE_COUNT];
    bool has_box;
    double low[3], high[3];
} cli_grid;

/* A volume as a command uses it. */
typedef struct cli_volume {
    const char *path, *format;
    cw_volume whole;     /* as the file has it, spacing applied; without the voxels */
    cw_volume voxels;    /* what was read of it: all, or what --crop leaves */
    cw_volume magnitude; /* of the chosen step, where --component mag asks for it */
    cw_volume prepared;  /* of the view, as --resample and --denoise left it; else empty */
    cw_volume view;      /* of that the chosen component, step and samples */
    double spacing[3];   /* of an irregular grid the mean length of cells' edges */
    cli_grid grid;       /* zeroed for other volumes */
    size_t memory_left;  /* of the limit, after the voxels */
    size_t coarsen[3];   /* the view's step along each axis */
    cli_change changes[CLI_MAX_CHANGES]; /* of the view, with the time they took */
    int change_count;
    bool streams;          /* voxels are not read: they do not fit, and come slice by slice */
    bool is_quiet;         /* prints no lines about the file */
    cw_label_table labels; /* names and colours of labels that the file holds */
    cw_label_ids ids;      /* numbers of labels that were replaced by their places */
    char notes[CLI_MAX_NOTES][256]; /* what the reader found and decided on */
    size_t note_count;
} cli_volume;

/* The least and the largest step along an axis of a rectilinear grid. */
void cli_spacing_range(const cli_volume *volume, int axis, double mm[2]);

/* Returns the claims about a file's coordinates in the library's form. */
cw_claim cli_claim_of(const cli_claim *claim);

/* Returns the options for a source volume beside a mesh, with the claims about the source. The
 * claims about the input are for the mesh. */
cli_input cli_source_input(const cli_input *input);

/* Returns the library's settings for reading, from the options. */
cw_read_desc cli_read_desc(const char *path, const cli_input *input);

/* Reads the header, says what was found, then reads the voxels (unless header_only). Errors
 * name the file. Free with cli_free_volume(). */
CW_NODISCARD cw_status cli_read_volume(const char *path, const cli_input *input,
                                       bool header_only, cli_volume *volume, cw_error *err);

/* Reads a volume to look at: integers that do not fit 32 bits are taken as numbers of labels. */
CW_NODISCARD cw_status cli_read_any_volume(const char *path, const cli_input *input,
                                           cli_volume *volume, cw_error *err);

/* All voxels of what --crop left a part of, without a word: the file was told of. Free with
 * cli_free_volume(). */
CW_NODISCARD cw_status cli_read_whole(const cli_volume *part, const cli_input *input,
                                      cli_volume *whole, cw_error *err);

/* Gives the slices of a volume that streams, as the options choose them, to a visitor. */
CW_NODISCARD cw_status cli_visit_slices(const cli_volume *volume, const cli_input *input,
                                        const cw_slice_visitor *visitor, cw_error *err);

/* Reads the header alone, and prints nothing. */
CW_NODISCARD cw_status cli_read_shape(const char *path, const cli_input *input,
                                      cw_volume *shape, cw_error *err);

void cli_free_volume(cli_volume *volume);

/* Says something about a volume, and keeps it as a note for reports. The second is for readers. */
void cli_note_volume(cli_volume *volume, const char *format, ...) CW_PRINTF(2, 3);
void cli_take_note(void *volume, const char *text);

/* Puts the notes as "notes". */
void cli_json_notes(cli_json *j, const cli_volume *volume);

enum { CLI_LABELS_TEXT = 128 };

/* Describes the labels that cw_volume_labels() found: "is a label map (116 labels, 1 to 116)". */
void cli_describe_labels(const cli_volume *volume, const cw_labels *labels,
                         char text[CLI_LABELS_TEXT]);

/* Says, and keeps as a note, that a volume of labels has several of them inside a surface,
 * which it joins. No levels: that any would. */
CW_NODISCARD cw_status cli_tell_labels(cli_volume *volume, const double *iso, size_t count,
                                       bool inside_is_low, cw_error *err);

/* --inside, and what it means for a volume. */
#define CLI_INSIDE_CHOICES "auto/above/below"
enum { CLI_INSIDE_AUTO, CLI_INSIDE_ABOVE, CLI_INSIDE_BELOW };
bool cli_inside_is_low(int inside, const cw_volume *volume);

/* Whether a file is a level set, which needs no isovalue: its surface is at 0. */
bool cli_is_level_set(const char *path, const cli_input *input);

/* Makes the volume's view that of another of its time steps. */
CW_NODISCARD cw_status cli_choose_step(const cli_input *input, size_t step, cli_volume *volume,
                                       cw_error *err);

/* Whether the view leaves voxels out between those it has. */
bool cli_is_preview(const cli_volume *volume);

/* "nifti, 181 x 217 x 181 u8, 1 x 1 x 1 mm", or "vtu, 21332 samples f64, 63008 tetrahedra,
 * ..." into static memory. */
const char *cli_describe(const cli_volume *volume);

/* An object of reports, such as "input". sha256 of the file, when it can be read again. */
void cli_json_input(cli_json *j, const char *key, const cli_volume *volume);

/* Returns --memory in bytes; default: three quarters of the machine's. */
size_t cli_memory_limit(const cli_input *input);

/* Returns the bytes that extraction takes beside voxels in memory, without the mesh: planes of bits,
 * numbers of rows, and the program, which counts unless the limit is too small for it. */
double cli_bytes_beside(double voxels, size_t limit);

/* A path as reports show it: absolute ones lose their folders. */
const char *cli_shown_path(const char *path);

#endif
