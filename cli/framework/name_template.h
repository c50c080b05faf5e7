/* Names of outputs with parts to be filled in: 'out/{stem}-{level}.glb'. */
#ifndef CLI_FRAMEWORK_NAME_TEMPLATE_H
#define CLI_FRAMEWORK_NAME_TEMPLATE_H

#include <cubewright/core.h>

/* A part: its name without the braces, what stands in its place, and whether it was
 * asked for. */
typedef struct cli_part {
    const char *name, *value;
    bool number; /* it may have a width: {step:04d} */
    bool used;
} cli_part;

/* The text with every {name} replaced by its value; {{ stands for a brace. Free it with free().
 * Sets used of the parts it holds.
 * Returns CW_ERR_ARGUMENT, with the names there are, for one that is none of the parts, and for
 *         a width that is none; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_fill_template(const char *text, cli_part *parts, size_t part_count,
                                         char **out, cw_error *err);

/* "head" of "scans/head.nii.gz": no folder, no .gz and no extension; "stdin" of "-". Free it with free(); NULL
 * when there is no memory. */
char *cli_stem(const char *path);

/* "sub-01" of "data/sub-01/aseg.nii.gz": the name of the folder that holds the file. "." where
 * the path names none. Free it with free(); NULL when there is no memory. */
char *cli_parent(const char *path);

#endif
