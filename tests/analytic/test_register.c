/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras of a room that another renderer photographed are put wrong, and registered again: how far
 * their images lie from the truth before and after, and what is left of it in albedo.
 */
#include "test.h"

#include "base/rng.h"
#include "scene/camera.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

typedef struct room {
    igi_context *ctx;
    igi_scene *scene;
    igi_camera *truth;
    char truth_folder[1100];
} room;

static bool open_room(const char *name, room *r)
{
    char path[1024];
    *r = (room){0};
    if (!test_shared_data(name, path, sizeof path)) return false;
    snprintf(r->truth_folder, sizeof r->truth_folder, "%s/truth", path);
    r->ctx = test_context(1);
    CHECK_OK(r->ctx, igi_scene_load(r->ctx, path, &r->scene));
    if (!r->scene) return false;
    r->truth = calloc(r->scene->frame_count, sizeof *r->truth);
    if (!r->truth) abort();
    for (size_t i = 0; i < r->scene->frame_count; i++) r->truth[i] = r->scene->frames[i].camera;
    return true;
}

static void close_room(room *r)
{
    free(r->truth);
    igi_scene_destroy(r->scene);
    igi_context_destroy(r->ctx);
}

static double normal(igi_rng *rng)
{
    double u = 1 - (double)igi_rng_float(rng);
    return sqrt(-2 * log(u)) * cos(2 * IGI_PI * (double)igi_rng_float(rng));
}

/* Turns and moves a camera so that its image shifts by about `px`: one half each. */
static void put_wrong(igi_camera *c, double px, double depth, igi_rng *rng)
{
    double w[3], old[3][4], sigma = px / sqrt(2) / sqrt(2) / c->fl_x;
    memcpy(old, c->camera_to_world, sizeof old);
    for (int k = 0; k < 3; k++) w[k] = sigma * normal(rng);
    for (int i = 0; i < 3; i++) {
        double *x = c->camera_to_world[i];
        x[0] = old[i][0] + w[2] * old[i][1] - w[1] * old[i][2];
        x[1] = old[i][1] - w[2] * old[i][0] + w[0] * old[i][2];
        x[2] = old[i][2] + w[1] * old[i][0] - w[0] * old[i][1];
        x[3] += depth * sigma * normal(rng);
    }
}

/* Root mean square of the shifts of the mesh's corners that the true camera sees. */
static double wrong_by(const room *r, size_t frame)
{
    double sum = 0, p[2], q[2];
    int count = 0;
    for (size_t i = 0; i < r->scene->mesh.vertex_count; i++) {
        igi_vec v = igi_v_of(r->scene->mesh.positions + 3 * i);
        const igi_camera *c = &r->truth[frame];
        if (!igi_camera_project(c, v, &p[0], &p[1]) || p[0] < 0 || p[1] < 0 || p[0] > c->width ||
            p[1] > c->height ||
            !igi_camera_project(&r->scene->frames[frame].camera, v, &q[0], &q[1]))
            continue;
        sum += (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
        count++;
    }
    return count ? sqrt(sum / count) : 0;
}

static double wrong_by_all(const room *r)
{
    double sum = 0;
    for (size_t i = 0; i < r->scene->frame_count; i++) sum += wrong_by(r, i) * wrong_by(r, i);
    return sqrt(sum / (double)r->scene->frame_count);
}

/* *registered: whether recovery moved the cameras by itself. */
static double albedo_error(const room *r, igi_registering when, bool *registered)
{
    static const char folder[] = "test_register.out";
    igi_recover_options options;
    igi_recovery *recovery = NULL;
    igi_validation *v = NULL;
    double error = 1;
    igi_recover_options_init(&options);
    options.model = IGI_LAMBERT;
    options.registering = when;
    CHECK_OK(r->ctx, igi_recover(r->ctx, r->scene, &options, &recovery));
    CHECK(mkdir(folder, 0777) == 0 || errno == EEXIST);
    if (!recovery) return 1;
    *registered = recovery->registered != NULL;
    CHECK_OK(r->ctx, igi_materials_save(r->ctx, recovery->materials, r->scene, folder));
    CHECK_OK(r->ctx, igi_validate(r->ctx, folder, r->truth_folder, &v));
    if (v) error = v->albedo_mean;
    igi_validation_destroy(v);
    igi_recovery_destroy(recovery);
    return error;
}

/* Albedo errs by .04 % with the cameras as given (tests/analytic/test_recover_rooms.c). */
static void noise_is_undone(void)
{
    room r;
    if (!open_room("scenes/cornell-diffuse", &r)) return;
    igi_rng rng = igi_rng_make(7, 200);
    for (size_t i = 0; i < r.scene->frame_count; i++)
        put_wrong(&r.scene->frames[i].camera, 2, 3, &rng);
    igi_registered *registered = NULL;
    double before = wrong_by_all(&r);
    CHECK_OK(r.ctx, igi_register(r.ctx, r.scene, NULL, &registered));
    bool moved = true;
    double after = wrong_by_all(&r), error = albedo_error(&r, IGI_REGISTER_AUTO, &moved);
    printf("cameras off by %.3f px, then %.3f px", before, after);
    if (registered)
        printf("; edges by %.3f px, then %.3f px", registered->before_px, registered->after_px);
    printf("; albedo %.3f %%\n", 100 * error);
    CHECK(before > 1.5 && after < .2);
    CHECK(error < .001 && !moved); /* what is registered is left alone */
    size_t honest = 0;
    for (size_t i = 0; registered && i < registered->frame_count; i++)
        honest += wrong_by(&r, i) < 5 * registered->frames[i].sigma_px;
    CHECK(honest + 3 >= r.scene->frame_count);
    igi_registered_destroy(registered);
    close_room(&r);
}

/* Recovery finds out for itself that cameras are off, and says so; told not to, it leaves them. */
static void recovery_registers(void)
{
    room r;
    if (!open_room("scenes/cornell-diffuse", &r)) return;
    igi_rng rng = igi_rng_make(8, 200);
    bool moved = false, kept = true;
    r.scene->frame_count = 12; /* enough, in half the time */
    for (size_t i = 0; i < r.scene->frame_count; i++)
        put_wrong(&r.scene->frames[i].camera, 2.5, 3, &rng);
    double error = albedo_error(&r, IGI_REGISTER_AUTO, &moved);
    double without = albedo_error(&r, IGI_REGISTER_NEVER, &kept);
    printf("albedo %.3f %%; with the cameras as given %.3f %%\n", 100 * error, 100 * without);
    CHECK(moved && !kept);
    CHECK(error < .001 && error < without / 3);
    r.scene->frame_count = 24;
    close_room(&r);
}

TEST_MAIN({"noise_is_undone", noise_is_undone}, {"recovery_registers", recovery_registers})
