/* Agreement among the processes of a team. */
#include <cubewright/team.h>

#include "core/base/status.h"

#include <string.h>

cw_status cw_team_gather(const cw_team *team, const void *mine, size_t bytes, void *all,
                         cw_error *err)
{
    CWI_REQUIRE(err, team);
    CWI_REQUIRE_ARRAY(err, mine, bytes);
    CWI_REQUIRE_ARRAY(err, all, bytes);
    if (team->size > 1)
        return team->gather(team->user, mine, bytes, all, err);
    memcpy(all, mine, bytes);
    return CW_OK;
}

cw_status cw_team_broadcast(const cw_team *team, int from, void *bytes, size_t size,
                            cw_error *err)
{
    CWI_REQUIRE(err, team);
    CWI_REQUIRE_ARRAY(err, bytes, size);
    return team->size > 1 ? team->broadcast(team->user, from, bytes, size, err) : CW_OK;
}

/* The outcome of a process: its status, and a hash of its message. */
typedef struct outcome {
    int32_t status;
    uint32_t message;
} outcome;

static uint32_t hash_message(const char *text)
{
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (; *text; text++)
        hash = (hash ^ (unsigned char)*text) * 16777619u;
    return hash;
}

cw_status cw_team_agree(const cw_team *team, cw_status status, cw_error *err)
{
    if (!team)
        return cwi_fail(err, CW_ERR_ARGUMENT, "cw_team_agree: 'team' is NULL");
    cw_error first_error = {.status = status};
    outcome all[CW_TEAM_MAX];
    int first = 0, alike = 0;
    if (team->size <= 1)
        return status;
    /* err holds the message of a failure before this call */
    if (status != CW_OK && err)
        memcpy(first_error.message, err->message, sizeof first_error.message);
    const outcome mine = {.status = (int32_t)status,
                          .message = hash_message(first_error.message)};
    cw_status st = cw_team_gather(team, &mine, sizeof mine, all, err);
    if (st != CW_OK)
        return st;
    while (first < team->size && all[first].status == CW_OK)
        first++;
    if (first == team->size)
        return CW_OK;
    for (int r = 0; r < team->size; r++)
        alike += memcmp(&all[r], &all[first], sizeof *all) == 0;
    st = cw_team_broadcast(team, first, &first_error, sizeof first_error, err);
    if (st != CW_OK)
        return st;
    return alike == team->size ? cwi_fail(err, first_error.status, "%s", first_error.message)
                               : cwi_fail(err, first_error.status, "rank %d: %.490s", first,
                                          first_error.message);
}
