/* SPDX-License-Identifier: Apache-2.0
 *
 * A first albedo is the ratio rho = pi sum L / sum E over some seen sides of a region, E from the
 * lights and from a few rays that look up what the photographs show of what they meet. Good to some
 * per cent: enough to see an albedo above one, and how far errors grow in this room.
 */
#include "check/survey.h"

#include "observe/lamp_profile.h"

#include <math.h>
#include <string.h>

#define PATCH_SHARE 0.0105f /* of the scene's size, as recovery has it */
#define SIDES 200           /* of a region that rays start from, about */
#define RAYS 16
#define LIGHT_RAYS 4

typedef struct sums {
    double radiance[IGI_MAX_BANDS], irradiance[IGI_MAX_BANDS];
    double rays, unseen, escaped;
} sums;

static igi_status average_sides(igi_context *ctx, igi_survey *s)
{
    const igi_observations *o = s->observations;
    size_t sides = 2 * s->patches->count, bands = (size_t)o->bands;
    IGI_TRY(IGI_ALLOC(ctx, sides, &s->seen));
    IGI_TRY(IGI_ALLOC(ctx, sides * bands, &s->radiance));
    for (size_t i = 0; i < o->count; i++) {
        uint32_t surface = o->surface[i];
        uint32_t side = igi_side_at(s->patches, igi_surface_triangle(surface), o->uv[2 * i],
                                    o->uv[2 * i + 1], igi_surface_is_back(surface));
        float profile = (float)igi_observation_profile(s->scene, o, i);
        if (!(profile > 0)) continue;
        s->seen[side]++;
        for (size_t b = 0; b < bands; b++)
            s->radiance[side * bands + b] += o->radiance[i * bands + b] / profile;
    }
    for (size_t k = 0; k < sides * bands; k++)
        if (s->seen[k / bands]) s->radiance[k] /= (float)s->seen[k / bands];
    return IGI_OK;
}

bool igi_survey_lamp(const igi_survey *s, int region, double radiance[IGI_MAX_BANDS])
{
    double pixels = 0;
    size_t bands = (size_t)s->scene->bands;
    for (size_t b = 0; b < bands; b++) radiance[b] = 0;
    for (uint32_t patch = 0; patch < s->patches->count; patch++) {
        if (s->patches->triangle[patch] == IGI_NO_HIT || s->seen[2 * patch] == 0 ||
            (int)igi_patch_region(s->patches, patch) != region)
            continue;
        pixels += s->seen[2 * patch];
        for (size_t b = 0; b < bands; b++)
            radiance[b] += s->seen[2 * patch] * (double)s->radiance[2 * patch * bands + b];
    }
    for (size_t b = 0; b < bands && pixels > 0; b++) radiance[b] /= pixels;
    return pixels > 0;
}

igi_status igi_survey_create(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                             const igi_observations *observations, igi_survey *s)
{
    igi_status status = IGI_OK;
    *s = (igi_survey){.scene = scene, .tracer = tracer, .observations = observations};
    float size = PATCH_SHARE * igi_tracer_size(tracer, NULL, NULL);
    IGI_TRY_GOTO(igi_patches_create(ctx, &scene->mesh, size, &s->patches));
    IGI_TRY_GOTO(average_sides(ctx, s));
    IGI_TRY_GOTO(igi_survey_coverage(ctx, s));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->light_count, &s->lights));
    for (size_t l = 0; l < scene->light_count; l++) {
        s->lights[l] = scene->lights[l];
        if (!s->lights[l].known && s->lights[l].type == IGI_LIGHT_AREA)
            (void)igi_survey_lamp(s, s->lights[l].region, s->lights[l].value);
    }
    IGI_TRY_GOTO(igi_lighting_create(ctx, scene, s->lights, scene->light_count, &s->lighting));
cleanup:
    if (status != IGI_OK) igi_survey_clear(s);
    return status;
}

void igi_survey_clear(igi_survey *s)
{
    igi_lighting_destroy(s->lighting);
    igi_patches_destroy(s->patches);
    igi_free(s->lights);
    igi_free(s->seen);
    igi_free(s->radiance);
    igi_free(s->views);
    igi_free(s->cosine);
    *s = (igi_survey){0};
}

static void add_lights(const igi_survey *s, igi_vec point, igi_vec normal, uint64_t key,
                       double *irradiance)
{
    for (size_t l = 0; l < s->scene->light_count; l++) {
        float unit = igi_light_irradiance(s->lighting, s->tracer, l, point, normal, LIGHT_RAYS,
                                          key + l);
        for (int b = 0; b < s->scene->bands; b++)
            irradiance[b] += (double)unit * s->lights[l].value[b];
    }
}

/* Rays from one side; what they meet that is not seen has the mean of what is. */
static void look_around(const igi_survey *s, uint32_t side, igi_rng *rng, sums *sum)
{
    size_t bands = (size_t)s->scene->bands;
    double gathered[IGI_MAX_BANDS] = {0}, direct[IGI_MAX_BANDS] = {0}, met = 0, lost = 0;
    uint32_t triangle;
    float u, v, shift[2] = {igi_rng_float(rng), igi_rng_float(rng)};
    igi_patch_sample(s->patches, side >> 1, rng, &triangle, &u, &v);
    igi_vec normal = igi_tracer_normal(s->tracer, triangle);
    igi_vec point = igi_triangle_point(&s->scene->mesh, triangle, u, v);
    if (side & 1) normal = igi_scale(normal, -1);
    for (int k = 0; k < RAYS; k++) {
        float x = shift[0] + (float)k * 0.7548776662f, y = shift[1] + (float)k * 0.5698402910f;
        igi_hit hit = igi_trace_off(s->tracer, point, normal,
                                    igi_cosine_direction(normal, x - floorf(x), y - floorf(y)));
        sum->rays++;
        if (hit.triangle == IGI_NO_HIT) {
            sum->escaped++;
            continue;
        }
        if (s->scene->regions[s->scene->mesh.regions[hit.triangle]].emitter) continue;
        uint32_t other = igi_side_at(s->patches, hit.triangle, hit.u, hit.v, hit.back);
        if (s->seen[other] == 0) {
            sum->unseen++;
            lost++;
            continue;
        }
        met++;
        for (size_t b = 0; b < bands; b++) gathered[b] += (double)s->radiance[other * bands + b];
    }
    add_lights(s, igi_madd(point, normal, igi_tracer_epsilon(s->tracer)), normal, igi_rng_next(rng),
               direct);
    for (size_t b = 0; b < bands && s->seen[side] > 0; b++) {
        double indirect = met > 0 ? gathered[b] * (1 + lost / met) / RAYS : 0;
        sum->irradiance[b] += direct[b] + IGI_PI * indirect;
        sum->radiance[b] += (double)s->radiance[side * bands + b];
    }
}

/* Area, observed share; and how many sides of each region are seen or not. */
static void measure_areas(const igi_survey *s, igi_check *check, size_t *sides)
{
    double all = 0, seen = 0;
    for (uint32_t patch = 0; patch < s->patches->count; patch++) {
        if (s->patches->triangle[patch] == IGI_NO_HIT) continue;
        uint32_t r = igi_patch_region(s->patches, patch);
        double area = (double)s->patches->area[patch];
        bool shown = s->seen[2 * patch] + s->seen[2 * patch + 1] > 0;
        check->regions[r].area += area;
        if (shown) check->regions[r].observed += area;
        if (s->views[2 * patch] + s->views[2 * patch + 1] == 1) check->regions[r].seen_once += area;
        if (!check->regions[r].emitter) {
            all += area;
            if (shown) seen += area;
        }
        sides[r] += (s->seen[2 * patch] > 0) + (s->seen[2 * patch + 1] > 0);
    }
    for (size_t r = 0; r < check->region_count; r++) {
        if (!(check->regions[r].area > 0)) continue;
        check->regions[r].observed /= check->regions[r].area;
        check->regions[r].seen_once /= check->regions[r].area;
    }
    check->unseen_area = all > 0 ? 1 - seen / all : 1;
}

static void count_views(const igi_survey *s, igi_check *check, bool *shown)
{
    const igi_observations *o = s->observations;
    for (size_t f = 0; f < o->frame_count; f++) {
        memset(shown, 0, check->region_count * sizeof *shown);
        for (size_t i = o->frame_begin[f]; i < o->frame_begin[f + 1]; i++)
            shown[s->scene->mesh.regions[igi_surface_triangle(o->surface[i])]] = true;
        for (size_t r = 0; r < check->region_count; r++) check->regions[r].views += shown[r];
    }
}

/* The whole room as one: mean albedo weighted by area, and how errors of it grow. */
static void conclude(const igi_survey *s, igi_check *check, const sums *all, const sums *unseen)
{
    double rho = 0, area = 0;
    bool lit = s->scene->light_count > 0;
    for (size_t l = 0; l < s->scene->light_count; l++)
        lit &= s->lights[l].known || s->lights[l].value[0] > 0;
    for (size_t r = 0; r < check->region_count; r++) {
        igi_region_check *out = &check->regions[r];
        out->unseen = all[r].rays > 0 ? all[r].unseen / all[r].rays : (double)NAN;
        out->escaped = all[r].rays > 0 ? all[r].escaped / all[r].rays : (double)NAN;
        for (int b = 0; b < s->scene->bands; b++) {
            bool known = all[r].irradiance[b] > 0 && !out->emitter && lit;
            out->albedo[b] = known ? IGI_PI * all[r].radiance[b] / all[r].irradiance[b]
                                   : (double)NAN;
            if (!known) continue;
            double weight = out->area * out->observed * (1 - out->escaped);
            rho += weight * fmin(out->albedo[b], 0.999);
            area += out->area * out->observed;
        }
    }
    double u = unseen->rays > 0 ? unseen->unseen / unseen->rays : 0;
    check->amplification = area > 0 ? 1 / (1 - rho / area) : (double)NAN;
    check->unseen_condition = area > 0 ? 1 / (1 - u * rho / area) : (double)NAN;
}

igi_status igi_survey_regions(igi_context *ctx, igi_survey *s, igi_check *check)
{
    igi_status status = IGI_OK;
    size_t *sides = NULL, unseen_sides = 0, n = check->region_count;
    bool *shown = NULL;
    sums *all = NULL, unseen = {{0}, {0}, 0, 0, 0};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &sides));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &shown));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &all));
    measure_areas(s, check, sides);
    count_views(s, check, shown);
    for (uint32_t side = 0; side < 2 * s->patches->count; side++) {
        if (s->patches->triangle[side >> 1] == IGI_NO_HIT) continue;
        uint32_t r = igi_patch_region(s->patches, side >> 1);
        igi_rng rng = igi_rng_make(igi_seed(ctx) + 0xc4ec, side);
        bool is_seen = s->seen[side] > 0;
        if (is_seen && igi_rng_float(&rng) * (float)sides[r] < SIDES)
            look_around(s, side, &rng, &all[r]);
        /* fronts that no photograph shows */
        if (!is_seen && !(side & 1) && !check->regions[r].emitter && s->seen[side ^ 1] == 0 &&
            unseen_sides++ % 8 == 0)
            look_around(s, side, &rng, &unseen);
    }
    double rays = unseen.rays;
    for (size_t r = 0; r < n; r++) rays += all[r].rays;
    igi_count_rays(ctx, (uint64_t)rays);
    conclude(s, check, all, &unseen);
cleanup:
    igi_free(sides);
    igi_free(shown);
    igi_free(all);
    return status;
}
