/* Options as tables: parsing, help and "did you mean" are made from the same rows. */
#ifndef CLI_FRAMEWORK_OPTIONS_H
#define CLI_FRAMEWORK_OPTIONS_H

#include <cubewright/core.h>

#include <stdio.h>

struct cli_option;

/* A kind of options. Rows of tables name kinds by the macros below. */
typedef struct cli_kind {
    size_t size; /* of the field */
    /* Stores the value of a text in a field; false: it is not of this kind. NULL: takes no value */
    bool (*parse)(const struct cli_option *option, const char *text, void *field);
    /* Prints a field as it would be typed, or nothing if it was not; NULL: nothing */
    void (*print)(const struct cli_option *option, const void *field, char *text, size_t size);
    const char *expected; /* for errors; NULL: the row's `value` */
    /* How quantities name their unit, for the manual page; NULL: it is no length, area or volume */
    const char *unit_rule;
    unsigned units; /* of a length: which it may have, as CLI_IN_ bits */
} cli_kind;

#define CLI_UNITS_MM "a unit of length"

/* Units of lengths. A bare number is no length. */
enum {
    CLI_IN_MM = 1,      /* mm, um, nm, cm, m, in, ft */
    CLI_IN_PERCENT = 2, /* of a box's diagonal */
    CLI_IN_VOXELS = 4,
    CLI_SIGNED = 8, /* and may be negative, or 0 */
};

extern const cli_kind cli_kind_flag, cli_kind_text, cli_kind_choice, cli_kind_number,
    cli_kind_numbers, cli_kind_level, cli_kind_levels, cli_kind_count, cli_kind_counts,
    cli_kind_bytes, cli_kind_lengths, cli_kind_length, cli_kind_mesh_length,
    cli_kind_voxel_length, cli_kind_print_length, cli_kind_shift, cli_kind_volume,
    cli_kind_sizes, cli_kind_ranges, cli_kind_crop, cli_kind_reduction, cli_kind_steps,
    cli_kind_weights, cli_kind_array, cli_kind_component, cli_kind_louder, cli_kind_heading;

#define CLI_FLAG   (&cli_kind_flag)   /* bool; --x and --no-x */
#define CLI_TEXT   (&cli_kind_text)   /* const char * */
#define CLI_CHOICE (&cli_kind_choice) /* int: the position in value, names parted by '/' */
#define CLI_NUMBER                                                                             \
    (&cli_kind_number) /* cli_number; the word of a row's `value`, such as none/V, too */
#define CLI_NUMBERS (&cli_kind_numbers) /* cli_numbers: 300 or 50,300 */
#define CLI_LEVEL   (&cli_kind_level)   /* cli_number: 300, 40%, otsu; names need a volume */
#define CLI_LEVELS  (&cli_kind_levels)  /* cli_numbers: several of them by comma */
#define CLI_COUNT   (&cli_kind_count)   /* size_t: 50k, 100M */
#define CLI_COUNTS  (&cli_kind_counts)  /* cli_counts: 50k,12k,3k */
#define CLI_BYTES   (&cli_kind_bytes)   /* size_t: 512M, 8G (1024s) */
#define CLI_LENGTHS (&cli_kind_lengths) /* cli_lengths: 0.5mm, 1x1x2mm */
/* cli_length: 0.1mm, 0.05% of a diagonal, 0.5vox. The word of a row's `value`, such as off of off/L,
 * is one, too. */
#define CLI_LENGTH       (&cli_kind_length)
#define CLI_MESH_LENGTH  (&cli_kind_mesh_length)  /* the same without voxels */
#define CLI_VOXEL_LENGTH (&cli_kind_voxel_length) /* without percent */
#define CLI_PRINT_LENGTH (&cli_kind_print_length) /* with neither */
#define CLI_SHIFT        (&cli_kind_shift)        /* cli_length: 1mm, -0.5%, 0 */
#define CLI_VOLUME       (&cli_kind_volume)       /* cli_amount: 500mm3, 0.5ml, 30vox */
#define CLI_SIZES        (&cli_kind_sizes)        /* cli_sizes: 64, 1280x720 or 512x512x300 */
#define CLI_RANGES       (&cli_kind_ranges) /* cli_ranges: 10:50,0:99,20:40 in voxels, or in mm */
#define CLI_CROP         (&cli_kind_crop)   /* cli_ranges: the same, or auto, auto:3 */
#define CLI_REDUCTION    (&cli_kind_reduction) /* cli_reduction */
#define CLI_STEPS        (&cli_kind_steps)     /* cli_steps: 0:20:2, 0,3,7 or all */
#define CLI_WEIGHTS      (&cli_kind_weights) /* cli_weights: normal:0.5; value has the names */
#define CLI_ARRAY        (&cli_kind_array)   /* cli_array: a name, NAME:1 or NAME:mag */
#define CLI_COMPONENT    (&cli_kind_component) /* cli_component: its number from 0, or mag */
#define CLI_LOUDER       (&cli_kind_louder)    /* int, counts up */
#define CLI_HEADING      (&cli_kind_heading) /* no option: the name of those below in the help */

/* How an isovalue is named. All but numbers become one when a volume is read. */
typedef enum cli_level {
    CLI_LEVEL_NUMBER,
    CLI_LEVEL_PERCENT, /* of the range of the values, as the number beside it says */
    CLI_LEVEL_OTSU,    /* those of cw_statistics_otsu(): of one level */
    CLI_LEVEL_DARK,    /* of three */
    CLI_LEVEL_MEDIUM,
    CLI_LEVEL_BRIGHT,
    CLI_LEVEL_BONE, /* in Hounsfield units, from here on */
    CLI_LEVEL_SKIN,
    CLI_LEVEL_SOFT,
    CLI_LEVEL_LUNG,
    CLI_LEVEL_METAL,
} cli_level;

typedef struct cli_number {
    bool given;
    bool is_word; /* the word of none/V; else: */
    double value;
    cli_level level;
} cli_number;

enum { CLI_MAX_NUMBERS = 64 };

typedef struct cli_numbers {
    size_t count; /* 0: none given */
    double value[CLI_MAX_NUMBERS];
    cli_level level[CLI_MAX_NUMBERS];
} cli_numbers;

enum { CLI_MAX_COUNTS = 16 };

typedef struct cli_counts {
    size_t count; /* 0: none given */
    size_t n[CLI_MAX_COUNTS];
} cli_counts;

typedef struct cli_lengths {
    bool given;
    double mm[3];
} cli_lengths;

typedef enum cli_length_unit { CLI_MM, CLI_PERCENT, CLI_VOXELS } cli_length_unit;

/* A length that may be told in proportion to something. */
typedef struct cli_length {
    bool given;
    bool is_word; /* the word of off/L or auto/L; else: */
    double value;
    cli_length_unit unit; /* millimetres, % of a box's diagonal, or voxels */
} cli_length;

/* A part of space. */
typedef struct cli_amount {
    bool given, voxels;
    double value; /* cubic millimetres, or as many voxels */
} cli_amount;

enum { CLI_MAX_WEIGHTS = 4 };

typedef struct cli_weights {
    bool given;
    double of[CLI_MAX_WEIGHTS]; /* the name at that position; 0: it was not named */
} cli_weights;

/* How far to simplify: to an error, or to a number of triangles. */
typedef struct cli_reduction {
    cli_length error; /* given, or else: */
    size_t triangles; /* 0: neither was said */
} cli_reduction;

/* Selection among the values of a voxel. */
typedef struct cli_component {
    bool given, magnitude; /* of the vector that they all are; else: */
    size_t number;
} cli_component;

/* Selects an array of a file and a component of it, which may also be given without the array. */
typedef struct cli_array {
    char name[4096]; /* empty: none was named */
    cli_component component;
} cli_array;

typedef struct cli_sizes {
    int count; /* 1 to 3 given, 0: none */
    size_t n[3];
} cli_sizes;

/* A box: from low to high along each axis, ends included. */
typedef struct cli_ranges {
    bool given;
    bool is_auto; /* given is false: around what is inside, with a margin in voxels */
    size_t margin;
    bool world; /* LPS millimetres; else voxel indices */
    double low[3], high[3];
} cli_ranges;

enum { CLI_MAX_STEPS = 64 };

/* Steps of a time series, ascending; each row runs from first to last, both included. */
typedef struct cli_steps {
    bool given, all;
    size_t count;
    struct {
        size_t first, last, by;
    } rows[CLI_MAX_STEPS];
} cli_steps;

/* Values that an option or an input may have, for the completion of shells. The words in lower
 * case of a row's `value`, such as off of off/L, are offered in any case. */
typedef enum cli_values {
    CLI_VALUES_ANY, /* nothing more is known */
    CLI_VALUES_FILE,
    CLI_VALUES_FOLDER,
    CLI_VALUES_VOLUME, /* files to read */
    CLI_VALUES_MESH,
    CLI_VALUES_SCENE, /* volumes and meshes */
    CLI_VALUES_STUDY, /* volumes, meshes, and fields that are known exactly */
    CLI_VALUES_VOLUME_OUTPUT,
    CLI_VALUES_MESH_OUTPUT,
    CLI_VALUES_DEFECTS, /* meshes with colours */
    CLI_VALUES_JSON,
    CLI_VALUES_JSON_INPUT,
    CLI_VALUES_JSON_LINES,
    CLI_VALUES_CSV,
    CLI_VALUES_HTML,
    CLI_VALUES_PNG,
    CLI_VALUES_PVD,
    CLI_VALUES_READER, /* names of formats */
    CLI_VALUES_MESH_READER,
    CLI_VALUES_MESH_WRITER,
    CLI_VALUES_TRANSFER,   /* transfer functions, and files of them */
    CLI_VALUES_VIEW,       /* views of a camera, and files of cameras */
    CLI_VALUES_FIELD,      /* fields that are known exactly */
    CLI_VALUES_MADE_FIELD, /* all fields of 'make' */
    CLI_VALUES_TOPIC,      /* commands and topics of 'help' */
    CLI_VALUES_MANUAL,     /* manual pages */
    CLI_VALUES_COUNT
} cli_values;

typedef struct cli_option {
    const char *name; /* without the dashes */
    char letter;      /* of the short form; 0: none */
    const cli_kind *kind;
    const char *value; /* what help calls the value; for CLI_CHOICE the choices */
    const char *about; /* for help; the default stands in brackets at the end */
    size_t offset;     /* of its field in the command's struct */
    cli_values values; /* for completion; 0: see cli_values */
} cli_option;

/* A rule between options. Names are parted by blanks: NAME, no-NAME for a flag that is off, or
 * NAME=VALUE for a choice. */
typedef struct cli_rule {
    const char *options; /* NULL: the command itself, in each run */
    enum { CLI_NEEDS, CLI_EXCLUDES } relation;
    const char *others; /* needed: one of these; excluded: each of these */
} cli_rule;

/* A row that is no option: the options below it stand under this name in the help. */
#define CLI_HEADED(name)                                                                       \
    {                                                                                          \
        name, 0, CLI_HEADING, NULL, "", 0                                                      \
    }

/* Rows of commands whose struct has the field `json`, or `progress`. */
#define CLI_JSON_OPTION(args)                                                                  \
    {                                                                                          \
        "json", 0, CLI_TEXT, "FILE", "Write a report as JSON; - is the standard output",       \
            offsetof(args, json), CLI_VALUES_JSON                                              \
    }
/* Of commands that refuse what is possible and most likely a mistake. common: the struct's member */
#define CLI_FORCE_OPTION(args, common)                                                         \
    {                                                                                          \
        "force", 0, CLI_FLAG, NULL,                                                            \
            "Do what is refused as a likely mistake, such as an error limit above 5 % of the " \
            "box's diagonal (off)",                                                            \
            offsetof(args, common.force)                                                       \
    }
#define CLI_PROGRESS_OPTION(args)                                                              \
    {                                                                                          \
        "progress", 0, CLI_CHOICE, "auto/plain/json/none",                                     \
            "Progress display on stderr (auto)", offsetof(args, progress)                      \
    }

/* Headings of options that a command must know before it opens a file. */
#define CLI_PREPARING "Preparing the volume"
#define CLI_READING   "Reading"
#define CLI_LIMITS    "Limits and messages"

enum { CLI_MAX_OPTIONS = 192 }; /* rows of a command's table */

/* Options of commands that take each input by itself: see batch.h. */
typedef struct cli_batch {
    bool is_batch, skip_existing, keep_going;
    size_t jobs;
    const char *json_lines;
} cli_batch;

/* An option as the command line gives it. */
typedef struct cli_given_option {
    const struct cli_option *option;
    const char *value; /* NULL: a flag */
    bool off;          /* a flag as --no-NAME */
} cli_given_option;

/* First member of every command's struct. */
typedef struct cli_common {
    bool help;
    bool quiet;
    bool force; /* of commands with CLI_FORCE_OPTION */
    int verbose;
    const char **inputs; /* the arguments that are no options */
    size_t input_count;
    cli_batch batch;
    const char *config, *save_config; /* files of a run: see run_config.h */
    const char *const *config_inputs; /* of --config, which count if the words have none */
    size_t config_input_count;
    struct cli_given_option
        *given_options; /* lists the options of the run; NULL: it does not */
    size_t given_count;
    size_t processes; /* of a batch, which share threads and memory; 0: this one alone */
    bool given[CLI_MAX_OPTIONS]; /* rows of the command's table that were */
} cli_common;

typedef struct cli_command {
    const char *name;
    const char *usage; /* after the name */
    const char *about; /* one line */
    const char *page;  /* the long help, help/NAME.txt: paragraphs and examples */
    const cli_option *options;
    size_t option_count;
    const cli_rule *rules; /* between options; see option_rules.h */
    size_t rule_count;
    size_t min_inputs, max_inputs;
    cli_values inputs; /* for completion */
    bool slices;       /* the input may be slices, which a shell may make many arguments of */
    size_t size;       /* of the struct that options fill in; it begins with cli_common */
    void (*print_more)(FILE *out); /* behind the options of the long help; NULL: nothing */
    const void *defaults;          /* that struct before any option; NULL: zeros */
    cw_status (*run)(void *args, cw_error *err);
} cli_command;

/* Fills in args (of command->size bytes, holding the defaults) from the words after the
 * command's name. inputs has room for all words. Returns CW_ERR_ARGUMENT with the nearest name
 * for an unknown option; checks nothing about the number of inputs when help is asked for. */
CW_NODISCARD cw_status cli_parse(const cli_command *command, int count, char **words,
                                 void *args, const char **inputs, cw_error *err);

/* Returns the option of a name, or NULL, and an error with the nearest name; err may be NULL. */
const cli_option *cli_find_option(const cli_command *command, const char *name, cw_error *err);

/* Returns whether a value is of the option's kind, and the words for that kind. */
bool cli_value_fits(const cli_option *option, const char *value);
const char *cli_expected(const cli_option *option);

/* Whether an option was given, of that name. */
bool cli_is_given(const cli_command *command, const cli_common *args, const char *name);

/* The value of an option that is no flag, as it would be said on the command line; of texts,
 * choices, numbers, counts, lengths and ranges. false: nothing was said. */
bool cli_option_text(const cli_option *option, const void *args, char *text, size_t size);

/* Returns the n-th option of a command, those that all commands have behind its own; NULL: there are
 * no more. */
const cli_option *cli_option_at(const cli_command *command, size_t n);

/* The help of a command: the options, and in the long form its page before them. */
void cli_print_help(const cli_command *command, bool long_form);

/* Prints a text where the cursor stands in a column: in lines of up to 96 columns that begin
 * there. */
void cli_print_wrapped(FILE *out, const char *text, size_t column);

/* The candidate most like a word, or NULL when none is close; names end with a NULL. */
const char *cli_nearest(const char *word, const char *const *names);

/* Names what the help has for a word that is no option of the command, or no command where that is
 * NULL: what is called so, or in_texts what mentions it. false: nothing. The program sets it. */
typedef bool cli_word_finder(const cli_command *command, const char *word, bool in_texts,
                             char *names, size_t size);
extern cli_word_finder *cli_find_word;

enum { CLI_HINT_BYTES = 400 };

/* Writes a hint for an unknown word: the name that may be meant, or where to look. */
void cli_hint(const cli_command *command, const char *word, const char *const *names,
              char hint[CLI_HINT_BYTES]);

extern const cli_option cli_common_options[];
extern const size_t cli_common_option_count;

#endif
