/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras that are off, or a mesh that is? Two accounts of the same edges, found from where the cameras were
 * given: each camera moved by six numbers of its own, or each thing (region) by six, the same in all
 * photographs. Both are fitted to where edges are, one camera or one thing at a time; -2 ln likelihood
 * and what the numbers cost (BIC) say which account is the better.
 */
#include "register/lines.h"
#include "scene/camera.h"

#include <math.h>

#define FEWEST 5
/* What cameras gain that would move: six numbers gain so much by chance, of a hundred once. Where none
 * would, shadows still have things gain. */
#define CLEAR 16.8
/* Over all cameras, so much of what edges gain must be gained by the prediction of the other regions'. */
#define PREDICTED .5

typedef struct account {
    double gain; /* of -2 ln likelihood, less what the numbers cost */
    double whole;
} account;

static void settle(const edge_lines *lines, account *a)
{
    motion m;
    double gain = 0;
    if (lines->count < FEWEST || !lines_solve(lines, NO_REGION, &m)) return;
    for (size_t i = 0; i < lines->count; i++) gain += line_gain(&lines->lines[i], m.x);
    gain /= lines->as_one;
    double cost = MOTION_NUMBERS * log(fmax(1, (double)lines->count / lines->as_one));
    a->whole += fmax(0, gain);
    a->gain += fmax(0, gain - cost);
}

static double unit_of(const camera_evidence *e)
{
    return fmax(1, e->spread);
}

static void judge_cameras(const register_job *j, edge_lines *lines, account *a)
{
    for (size_t f = 0; f < j->scene->frame_count; f++) {
        const camera_evidence *e = &j->evidence[f];
        lines->count = 0;
        if (lines_of_camera(&e->sites, &e->start, unit_of(e), lines)) settle(lines, a);
    }
}

/* Where a thing is, and what moves its picture by about a pixel. */
static size_t find_units(const register_job *j, uint32_t region, thing_units *u)
{
    igi_vec sum = {0, 0, 0};
    double pixel = 0, radius = 0;
    size_t count = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t f = 0; f < j->scene->frame_count; f++) {
            const camera_evidence *e = &j->evidence[f];
            igi_vec eye = igi_camera_centre(&e->start);
            for (size_t i = 0; i < e->sites.count; i++) {
                const igi_edge_site *s = &e->sites.sites[i];
                if (s->region != region) continue;
                if (pass == 0) {
                    sum = igi_add(sum, s->point);
                    pixel += (double)igi_length(igi_sub(s->point, eye)) / e->start.fl_x;
                    count++;
                } else radius += (double)igi_length(igi_sub(s->point, u->centre));
            }
            if (pass == 0 && count > 0) u->centre = igi_scale(sum, 1 / (float)count);
        }
    if (count == 0) return 0;
    u->move_m = pixel / (double)count;
    u->turn_rad = u->move_m / fmax(radius / (double)count, u->move_m);
    return count;
}

static void judge_things(const register_job *j, edge_lines *lines, account *a)
{
    for (uint32_t r = 0; r < j->scene->region_count; r++) {
        thing_units units;
        if (find_units(j, r, &units) < FEWEST) continue;
        lines->count = 0;
        for (size_t f = 0; f < j->scene->frame_count; f++) {
            const camera_evidence *e = &j->evidence[f];
            lines_of_thing(&e->sites, r, &e->start, unit_of(e), &units, lines);
        }
        settle(lines, a);
    }
}

static void put_back(register_job *j)
{
    for (size_t i = 0; i < j->scene->frame_count; i++) {
        igi_registered_frame *f = &j->out->frames[i];
        j->scene->frames[i].camera = j->evidence[i].start;
        f->moved = j->out->lens || j->out->world;
        f->after_px = f->before_px;
        if (!f->moved) f->moved_px = 0;
        f->unsettled = false;
    }
}

/* Of some cameras alone, nothing is said of the mesh. */
igi_status register_judge(igi_context *ctx, register_job *j)
{
    double gain = 0, most = 0, typical = j->alignment.typical_px;
    size_t count = 0;
    account cameras = {0, 0}, things = {0, 0};
    edge_lines lines = {.as_one = fmax(1, IGI_SITES_AS_ONE * j->scene->frames[0].camera.height),
                        .expected_px = fmax(.5, typical)};
    for (size_t i = 0; i < j->scene->frame_count; i++) {
        gain += j->evidence[i].gain;
        most += j->evidence[i].most;
        count += j->evidence[i].sites.count;
    }
    if (j->which || most < CLEAR) return IGI_OK;
    IGI_TRY(IGI_ALLOC(ctx, count, &lines.lines));
    judge_cameras(j, &lines, &cameras);
    judge_things(j, &lines, &things);
    igi_free(lines.lines);
    j->out->mesh_is_off = things.gain > cameras.gain || gain < PREDICTED * most;
    if (j->out->mesh_is_off) put_back(j);
    return IGI_OK;
}
