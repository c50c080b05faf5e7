/* Runs other libraries at the same work. Those with Python bindings are programs: the common
 * peer.py, followed by peer_NAME.py. These are children that live as long as the run, so that
 * neither Python's start nor its imports are timed. They run in the scratch folder.
 * Each command is one line, and so is each answer:
 *
 *     (nothing)                                  ready VERSION, or: missing MODULE
 *     extract TYPE NX NY NZ DX DY DZ LEVEL OUT   ok: the file "volume" is read
 *     simplify VERTICES TRIANGLES TARGET         ok: the file "mesh" is
 *     run                                        ok SECONDS PEAK_BYTES
 *     save                                       ok VERTICES TRIANGLES NORMALS: to "result"
 *
 * "volume" has voxels, x fastest; DX is their distance, LEVEL in their unit, OUT a value that
 * is outside. Meshes are positions, normals (if NORMALS is 1) and triangles, as in cw_mesh. */
#ifndef CLI_BENCH_BENCH_PEERS_H
#define CLI_BENCH_BENCH_PEERS_H

#include "cli/bench/bench_child.h"

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

typedef enum cli_peer_id {
    CLI_PEER_VTK,
    CLI_PEER_SKIMAGE,
    CLI_PEER_OPENVDB,
    CLI_PEER_MESHOPT,
    CLI_PEER_DRACO,
    CLI_PEER_COUNT
} cli_peer_id;

typedef enum cli_peer_state {
    CLI_PEER_UNTRIED,
    CLI_PEER_READY,
    CLI_PEER_MISSING,
    CLI_PEER_FAILED
} cli_peer_state;

typedef struct cli_peer {
    const char *name;
    const char *package; /* Debian's, that brings it */
    cli_peer_state state;
    char version[32]; /* empty: it does not tell */
    char why[256];    /* if not ready */
    char path[4096];  /* of its program: python3 or draco_encoder */
    cli_child child;
} cli_peer;

typedef struct cli_peers {
    cli_peer of[CLI_PEER_COUNT];
    const char *folder;
    int threads;
    double limit_s; /* for one answer */
} cli_peers;

/* Time and memory that one run took. */
typedef struct cli_spent {
    double seconds;
    size_t peak_bytes; /* beyond what was there before; 0: unknown */
} cli_spent;

/* Finds out which are there. CW_ERR_CANCELLED; what else goes wrong is in the peers' state. */
CW_NODISCARD cw_status cli_peers_start(cli_peers *peers, const char *folder, int threads,
                                       double limit_s, cw_error *err);
void cli_peers_stop(cli_peers *peers);

/* Writes the files that peers read of a case: once for all of them. CW_ERR_OUTPUT */
CW_NODISCARD cw_status cli_peers_put_volume(const cli_peers *peers, const cw_volume *volume,
                                            cw_error *err);
CW_NODISCARD cw_status cli_peers_put_mesh(const cli_peers *peers, const cw_mesh *mesh,
                                          cw_error *err);

/* Has a peer with a child prepare what is to be run; starts that again where it has ended.
 * Returns  CW_ERR_BACKEND, as all below, with how it failed; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cli_peer_prepare_volume(cli_peers *peers, cli_peer *peer,
                                               const cw_volume *volume, double iso,
                                               bool inside_is_low, cw_error *err);
CW_NODISCARD cw_status cli_peer_prepare_mesh(cli_peers *peers, cli_peer *peer,
                                             const cw_mesh *mesh, size_t target, cw_error *err);
CW_NODISCARD cw_status cli_peer_run(cli_peer *peer, cli_spent *spent, cw_error *err);

/* The result, checked. placed  NULL: as it is; else it is in mm along that volume's axes, from
 * its first voxel on, and is put into its frame */
CW_NODISCARD cw_status cli_peer_take(cli_peers *peers, cli_peer *peer, const cw_volume *placed,
                                     cw_mesh *mesh, cw_error *err);

#endif
