/* SPDX-License-Identifier: Apache-2.0
 *
 * The renderer against photographs that another renderer took (Mitsuba 3), with the true
 * materials: the mean of every region, over a few views, within 0.2 % (of relit views, which are
 * noisier, the mean of all). This holds our reading of
 * the lobes, of textures, of lights and of cameras to the formats.
 */
#include "test.h"

#include "base/context.h"
#include "scene/camera.h"
#include "trace/trace.h"

enum { MOST_REGIONS = 64, SAMPLES = 16 };

typedef struct tally {
    double ours, theirs, variance; /* sums over bands and pixels; variance of the difference */
} tally;

typedef struct shooting {
    igi_context *ctx;
    igi_scene *scene;
    igi_materials *truth;
    igi_tracer *tracer;
    double their_samples;
    bool regions_too;
    tally all, regions[MOST_REGIONS];
} shooting;

static void add_pixel(const shooting *s, tally *t, const igi_image *ours, const igi_image *variance,
                      const igi_image *theirs, size_t at)
{
    for (size_t b = 0; b < (size_t)s->scene->bands; b++) {
        t->ours += (double)ours->samples[at + b];
        t->theirs += (double)theirs->samples[at + b];
        t->variance += (double)variance->samples[at + b] * (1 + SAMPLES / s->their_samples);
    }
}

static void compare_view(shooting *s, const igi_light *lights, size_t light_count,
                         const igi_frame *frame)
{
    igi_render_options options;
    igi_image *ours = NULL, *variance = NULL, *theirs = NULL;
    igi_render_options_init(&options);
    options.samples = SAMPLES;
    CHECK_OK(s->ctx, igi_image_load_exr(s->ctx, frame->path, &theirs));
    CHECK_OK(s->ctx, igi_render(s->ctx, s->scene, s->truth, lights, light_count, &frame->camera,
                                &options, &ours, &variance));
    if (!ours || !theirs || theirs->channels != s->scene->bands) abort();
    igi_vec eye = igi_camera_centre(&frame->camera);
    for (int y = 0; y < ours->height; y++)
        for (int x = 0; x < ours->width; x++) {
            igi_hit hit = igi_trace(s->tracer, eye,
                                    igi_camera_direction(&frame->camera, x + .5, y + .5));
            if (hit.triangle == IGI_NO_HIT) continue;
            uint32_t region = s->scene->mesh.regions[hit.triangle];
            if (s->scene->regions[region].emitter) continue;
            size_t at = ((size_t)y * (size_t)ours->width + (size_t)x) * (size_t)s->scene->bands;
            add_pixel(s, &s->all, ours, variance, theirs, at);
            add_pixel(s, &s->regions[region], ours, variance, theirs, at);
        }
    igi_image_destroy(ours);
    igi_image_destroy(variance);
    igi_image_destroy(theirs);
}

static void judge(const char *name, const tally *t)
{
    if (!(t->theirs > 0)) return;
    double ratio = t->ours / t->theirs, sigma = sqrt(t->variance) / t->theirs;
    CHECK_NEAR(ratio, 1, .002 + 3.5 * sigma);
    if (fabs(ratio - 1) > .002 + 3.5 * sigma) printf("  region %s\n", name);
}

static bool begin(shooting *s, const char *name, double their_samples)
{
    char path[1024], truth[1100];
    if (!test_shared_data(name, path, sizeof path)) return false;
    *s = (shooting){.ctx = test_context(2), .their_samples = their_samples};
    snprintf(truth, sizeof truth, "%s/truth", path);
    CHECK_OK(s->ctx, igi_scene_load(s->ctx, path, &s->scene));
    CHECK_OK(s->ctx, igi_materials_load(s->ctx, truth, &s->truth));
    if (!s->scene || !s->truth || s->scene->region_count > MOST_REGIONS) abort();
    CHECK_OK(s->ctx, igi_tracer_create(s->ctx, &s->scene->mesh, &s->tracer));
    return true;
}

static void end(shooting *s)
{
    judge("all", &s->all);
    CHECK(sqrt(s->all.variance) < 1e-3 * s->all.theirs);
    for (size_t i = 0; s->regions_too && i < s->scene->region_count; i++)
        judge(s->scene->regions[i].name, &s->regions[i]);
    igi_tracer_destroy(s->tracer);
    igi_materials_destroy(s->truth);
    igi_scene_destroy(s->scene);
    igi_context_destroy(s->ctx);
}

static void compare_scene(const char *name, double their_samples)
{
    shooting s;
    if (!begin(&s, name, their_samples)) return;
    s.regions_too = true;
    for (size_t i = 2; i < s.scene->frame_count; i += 9)
        compare_view(&s, s.scene->lights, s.scene->light_count, &s.scene->frames[i]);
    end(&s);
}

static void compare_relit(const char *name, const char *folder, double their_samples)
{
    shooting s;
    char path[1024], file[1100];
    igi_light *lights = NULL;
    igi_frame *frames = NULL;
    size_t light_count = 0, frame_count = 0;
    if (!begin(&s, name, their_samples)) return;
    snprintf(path, sizeof path, "%s/%s", s.scene->folder, folder);
    snprintf(file, sizeof file, "%s/lights.json", path);
    CHECK_OK(s.ctx, igi_lights_load(s.ctx, s.scene, file, &lights, &light_count));
    snprintf(file, sizeof file, "%s/transforms.json", path);
    CHECK_OK(s.ctx, igi_frames_load(s.ctx, file, &frames, &frame_count));
    for (size_t i = 0; i < frame_count; i++) compare_view(&s, lights, light_count, &frames[i]);
    igi_lights_destroy(lights, light_count);
    igi_frames_destroy(frames, frame_count);
    end(&s);
}

static void cornell_diffuse(void)
{
    compare_scene("scenes/cornell-diffuse", 192);
}

static void cubical_room(void)
{
    compare_scene("scenes/cubical-room", 128);
}

static void office(void)
{
    compare_scene("scenes/office", 128);
}

static void relit_by_point(void)
{
    compare_relit("scenes/cornell-diffuse", "relit", 192);
}

static void relit_by_spot(void)
{
    compare_relit("scenes/office", "relit2", 128);
}

TEST_MAIN({"cornell-diffuse", cornell_diffuse}, {"cubical-room", cubical_room}, {"office", office},
          {"relit by point", relit_by_point}, {"relit by spot", relit_by_spot})
