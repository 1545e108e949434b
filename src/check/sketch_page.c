/* SPDX-License-Identifier: Apache-2.0
 *
 * check.html as a whole: what its sections draw from is looked at once, then they follow each other.
 */
#include "check/sketch.h"

#include "base/order.h"
#include "scene/camera.h"

#include <math.h>
#include <stdlib.h>

enum { ROOM_WIDTH = 360, SCAN_COLUMNS = 24, SCAN_ROWS = 18 };
#define MIDDLE 0.25f /* what the median of the photographs becomes, linear */

/* The median of what sides show becomes a middle grey. */
static igi_status find_exposure(igi_sketch *s)
{
    const igi_survey *survey = s->c->survey;
    size_t sides = 2 * survey->patches->count, bands = (size_t)s->c->scene->bands, count = 0;
    float *values;
    IGI_TRY(IGI_ALLOC(s->c->ctx, sides + 1, &values));
    for (size_t side = 0; side < sides; side++) {
        float sum = 0;
        for (size_t b = 0; b < bands; b++) sum += survey->radiance[side * bands + b];
        if (survey->views[side] && sum > 0) values[count++] = sum / (float)bands;
    }
    qsort(values, count, sizeof *values, igi_compare_floats);
    s->exposure = count ? MIDDLE / values[count / 2] : 1;
    igi_free(values);
    return IGI_OK;
}

static igi_status look_at_rooms(igi_sketch *s)
{
    const igi_survey *survey = s->c->survey;
    igi_vec up = igi_survey_up(survey), a, b;
    a = fabsf(up.x) > 0.5f ? igi_v(0, 1, 0) : igi_v(1, 0, 0);
    b = igi_cross(up, a);
    igi_vec across = igi_add(igi_scale(a, 0.5f), igi_scale(b, 0.75f));
    const igi_vec ways[IGI_ROOMS] = {
        [IGI_ROOM_ABOVE] = igi_madd(across, up, -0.8f),
        [IGI_ROOM_OPPOSITE] = igi_madd(igi_scale(across, -1), up, -0.8f),
        [IGI_ROOM_BELOW] = igi_madd(across, up, 0.8f),
        [IGI_ROOM_PLAN] = igi_scale(up, -1)};
    IGI_TRY(igi_survey_outside(s->c->ctx, survey, &s->cut));
    for (int k = 0; k < IGI_ROOMS; k++) {
        igi_view_outside(survey, ways[k], ROOM_WIDTH, &s->rooms[k]);
        s->rooms[k].cut = s->cut;
        IGI_TRY(igi_view_look(s->c->ctx, &s->rooms[k]));
    }
    return IGI_OK;
}

/* At some places of a frame: do they mirror a lamp? */
static size_t scan(const igi_sketch *s, size_t frame)
{
    const igi_survey *survey = s->c->survey;
    const igi_camera *camera = &s->c->scene->frames[frame].camera;
    igi_vec eye = igi_camera_centre(camera);
    size_t found = 0;
    for (int k = 0; k < SCAN_COLUMNS * SCAN_ROWS; k++) {
        double x = (k % SCAN_COLUMNS + .5) / SCAN_COLUMNS * camera->width,
               y = (k / SCAN_COLUMNS + .5) / SCAN_ROWS * camera->height;
        igi_hit hit = igi_trace(survey->tracer, eye, igi_camera_direction(camera, x, y));
        if (hit.triangle == IGI_NO_HIT ||
            s->c->scene->regions[s->c->scene->mesh.regions[hit.triangle]].emitter)
            continue;
        igi_vec normal = igi_tracer_normal(survey->tracer, hit.triangle);
        if (hit.back) normal = igi_scale(normal, -1);
        igi_vec at = igi_triangle_point(&s->c->scene->mesh, hit.triangle, hit.u, hit.v);
        found += igi_survey_mirrors_lamp(survey, eye, at, normal);
    }
    return found;
}

static igi_status scan_photographs(igi_sketch *s)
{
    const igi_observations *o = s->c->survey->observations;
    IGI_TRY(IGI_ALLOC(s->c->ctx, o->frame_count, &s->lamp_pixels));
    IGI_TRY(IGI_ALLOC(s->c->ctx, o->frame_count, &s->mirrored));
    for (size_t f = 0; f < o->frame_count; f++) {
        for (size_t i = o->frame_begin[f]; i < o->frame_begin[f + 1]; i++) {
            uint32_t region = s->c->scene->mesh.regions[igi_surface_triangle(o->surface[i])];
            s->lamp_pixels[f] += s->c->scene->regions[region].emitter;
        }
        s->mirrored[f] = scan(s, f);
    }
    igi_count_rays(s->c->ctx, o->frame_count * SCAN_COLUMNS * SCAN_ROWS);
    return IGI_OK;
}

static void print_tile(FILE *f, const char *name, double x, int digits, const char *unit)
{
    fprintf(f, "<div><dt>%s</dt><dd>", name);
    if (isnan(x)) fputs("&ndash;", f);
    else fprintf(f, "%.*f%s", digits, x, unit);
    fputs("</dd></div>", f);
}

static double surroundings_of(const igi_check *check)
{
    double sum = 0, weights = 0;
    for (size_t r = 0; r < check->region_count; r++) {
        const igi_region_check *region = &check->regions[r];
        if (region->emitter || isnan(region->unseen)) continue;
        sum += region->area * region->observed * region->unseen;
        weights += region->area * region->observed;
    }
    return weights > 0 ? sum / weights : (double)NAN;
}

static void print_head(const igi_sketch *s)
{
    FILE *f = s->page->file;
    const igi_check *check = s->c->check;
    static const char *const said[] = {"Everything that recovery assumes holds.",
                                       "Recovery will run. Of what it assumes, some is doubtful; "
                                       "each doubt stands below with what "
                                       "would settle it.",
                                       "Recovery has no answer to this scene, or a wrong one: what "
                                       "fails stands below with what to "
                                       "do."};
    igi_page_begin(s->page, s->c->scene->name,
                   "Before the long work: what these photographs can tell about the room, and what "
                   "to do about what they cannot.");
    fprintf(f, "<p class=\"verdict v%d\"><b>%s</b></p><dl class=\"tiles\">", (int)check->verdict,
            said[check->verdict]);
    print_tile(f, "photographs", (double)check->photo_count, 0, "");
    print_tile(f, "surface in a photograph", 100 * (1 - check->unseen_area), 1, "&nbsp;%");
    print_tile(f, "of what surfaces face, unseen", 100 * surroundings_of(check), 1, "&nbsp;%");
    print_tile(f, "errors grow when relighting", check->amplification, 1, "&times;");
    fputs("</dl>\n", f);
    if (check->warning_count == 0) return;
    fputs("<div class=\"warnings\"><b>What recovery will warn of</b><ul>", f);
    for (size_t i = 0; i < check->warning_count; i++) {
        fputs("<li>", f);
        igi_page_text(s->page, check->warnings[i]);
        fputs("</li>", f);
    }
    fputs("</ul></div>\n", f);
}

static igi_status print_page(const igi_page *page, const void *user)
{
    igi_sketch s = *(const igi_sketch *)user;
    s.page = page;
    print_head(&s);
    IGI_TRY(igi_sketch_assumptions(&s));
    IGI_TRY(igi_sketch_proposals(&s));
    IGI_TRY(igi_sketch_coverage(&s));
    IGI_TRY(igi_sketch_photographs(&s));
    igi_sketch_lights(&s);
    igi_page_end(page);
    return IGI_OK;
}

igi_status igi_sketch_save(const igi_case *c, const char *folder)
{
    igi_status status = IGI_OK;
    igi_page page = {.ctx = c->ctx, .folder = folder};
    igi_sketch s = {.c = c};
    char *path = NULL;
    igi_stage_begin(c->ctx, "pictures");
    IGI_TRY_GOTO(IGI_ALLOC(c->ctx, 6 * c->survey->patches->count, &s.colours));
    IGI_TRY_GOTO(find_exposure(&s));
    IGI_TRY_GOTO(look_at_rooms(&s));
    IGI_TRY_GOTO(scan_photographs(&s));
    IGI_TRY_GOTO(igi_strprintf(c->ctx, &path, "%s/check.html", folder));
    IGI_TRY_GOTO(igi_page_write(&page, path, print_page, &s));
cleanup:
    for (int k = 0; k < IGI_ROOMS; k++) igi_view_clear(&s.rooms[k]);
    igi_free(s.cut);
    igi_free(s.colours);
    igi_free(s.lamp_pixels);
    igi_free(s.mirrored);
    igi_free(path);
    return status;
}
