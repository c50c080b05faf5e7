/* Finds out which MPI started the process, and loads the module for it. */
#include <cubewright/team.h>

#include "core/base/module.h"
#include "core/base/status.h"
#include "core/files/atomic_file.h"
#include "core/team/mpi_wrap.h"

#include <stdlib.h>

static const cwi_mpi_functions *mpi; /* NULL: not in a team */

/* Returns the module for the launcher that set its variables with more than one process; NULL:
 * none. */
static const char *find_launcher(void)
{
    static const struct {
        const char *variable, *module;
    } launchers[] = {{"OMPI_COMM_WORLD_SIZE", "openmpi"}, {"PMI_SIZE", "mpich"}};
    for (size_t n = 0; n < sizeof launchers / sizeof *launchers; n++) {
        const char *size = getenv(launchers[n].variable);
        if (size)
            return strtol(size, NULL, 10) > 1 ? launchers[n].module : NULL;
    }
    return NULL;
}

bool cw_team_is_started(void)
{
    return find_launcher() != NULL;
}

cw_status cw_team_join(cw_team *team, cw_error *err)
{
    CWI_REQUIRE(err, team);
    const char *module = find_launcher();
    const cwi_lost_rank lost = {.remove_temporaries = cwi_outfile_end_all,
                                .exit_code = cw_status_exit_code(CW_ERR_IO)};
    const void *functions = NULL;
    *team = (cw_team){.size = 1, .on_this_host = 1};
    if (!module)
        return CW_OK;
    cw_status st = cwi_module_load(module, &functions, err);
    if (st != CW_OK)
        return st;
    const cwi_mpi_functions *loaded = functions;
    st = loaded->join(team, &lost, err);
    if (st == CW_OK)
        mpi = loaded;
    return st;
}

void cw_team_leave(cw_team *team)
{
    if (!team)
        return;
    if (mpi && team->size > 1)
        mpi->leave();
    mpi = NULL;
    *team = (cw_team){0};
}
