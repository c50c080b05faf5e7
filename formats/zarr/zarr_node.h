/* The nodes of a Zarr store: arrays, groups, and images of OME-Zarr in several sizes. */
#ifndef FORMATS_ZARR_ZARR_NODE_H
#define FORMATS_ZARR_ZARR_NODE_H

#include "formats/zarr/zarr_array.h"

typedef enum cwi_zarr_kind {
    CWI_ZARR_NOTHING,
    CWI_ZARR_IS_ARRAY,
    CWI_ZARR_IS_GROUP
} cwi_zarr_kind;

/* A node. A zeroed one is closed. */
typedef struct cwi_zarr_node {
    char path[CWI_ZARR_KEY_BYTES]; /* below the store; "" for the store itself */
    cwi_zarr_kind kind;
    const cwi_zarr_words *words;
    cwi_zarr_json meta;       /* zarr.json, .zarray, .zgroup, or the file of another dialect */
    cwi_zarr_json attributes; /* .zattrs of version 2 */
    const json_t *attrs;      /* the attributes of either version; may be NULL */
    const json_t *ome;        /* the object with "multiscales" and "image-label"; may be NULL */
    const json_t *scale;      /* of dialects that tell of all levels in one file; else NULL */
    size_t levels;            /* of dialects that count them when they open it */
} cwi_zarr_node;

struct cwi_zarr_dialect;

/* Opens the node of a folder, or none (CWI_ZARR_NOTHING). Close it in any case.
 * Returns CW_ERR_FORMAT, CW_ERR_UNSAFE: a path that leaves the store; CW_ERR_IO,
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_zarr_node_open(cwi_zarr_node *node, const cwi_input *in,
                                          const char *path, cw_error *err);
void cwi_zarr_node_close(cwi_zarr_node *node);

/* Fills an array from the metadata of its node. Messages name the file. */
CW_NODISCARD cw_status cwi_zarr_node_array(const struct cwi_zarr_dialect *dialect,
                                           const cwi_zarr_node *node, cwi_zarr_array *array,
                                           cw_error *err);

/* Fills an array from the metadata of version 2 or 3. */
CW_NODISCARD cw_status cwi_zarr_parse(const cwi_zarr_node *node, cwi_zarr_array *array,
                                      cw_error *err);

/* Opens a document of a node by the name of its file. */
CW_NODISCARD cw_status cwi_zarr_node_json(const cwi_zarr_node *node, const cwi_input *in,
                                          const char *name, cwi_zarr_json *json, cw_error *err);

/* Joins two paths; a name of "" or "." is the path itself. Returns CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_zarr_join(const char *path, const char *name,
                                     char joined[CWI_ZARR_KEY_BYTES], cw_error *err);

/* Puts the path of a node's metadata file in front of a message. */
cw_status cwi_zarr_fail_in(cw_error *err, cw_status status, const cwi_zarr_node *node,
                           bool in_attributes);

/* The list of arrays and images below a group. */
typedef struct cwi_zarr_listing {
    cwi_names paths; /* in natural order */
    size_t visited;  /* folders that were looked at */
} cwi_zarr_listing;

/* Lists the arrays and images below a group, itself not among them. Images are not entered.
 * Returns CW_ERR_LIMIT for more than 4096 folders; folders nested deeper than 8 are left out */
CW_NODISCARD cw_status cwi_zarr_list(const struct cwi_zarr_dialect *dialect,
                                     const cwi_input *in, const char *path,
                                     cwi_zarr_listing *list, cw_error *err);

#endif
