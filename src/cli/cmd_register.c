/* SPDX-License-Identifier: Apache-2.0
 *
 * igi register: cameras refined against the mesh.
 */
#include "cli.h"

#include <math.h>

static igi_status move_by_points(cli_session *s, igi_scene *scene, double *rms_m)
{
    igi_point_pair *pairs = NULL;
    size_t count = 0;
    igi_similarity similarity;
    igi_status status = igi_point_pairs_read(s->context, s->values.points, &pairs, &count);
    if (status == IGI_OK) status = igi_similarity_fit(s->context, pairs, count, &similarity, rms_m);
    if (status == IGI_OK) igi_scene_move_cameras(scene, &similarity);
    igi_point_pairs_destroy(pairs);
    return status;
}

static void print_json(const cli_session *s, const igi_scene *scene, const igi_registered *r)
{
    printf("{\"output\": ");
    cli_print_json_string(s->values.output);
    printf(", \"before_px\": ");
    cli_print_json_number(r->before_px);
    printf(", \"after_px\": ");
    cli_print_json_number(r->after_px);
    printf(", \"gain_spread\": ");
    cli_print_json_number(r->gain_spread);
    printf(", \"contradicts\": ");
    cli_print_json_number(r->contradicts);
    printf(",\n \"frames\": [");
    for (size_t i = 0; i < r->frame_count; i++) {
        const igi_registered_frame *f = &r->frames[i];
        const struct {
            const char *name;
            double value;
        } numbers[] = {{"before_px", f->before_px}, {"after_px", f->after_px},
                       {"moved_px", f->moved_px},   {"sigma_px", f->sigma_px},
                       {"gain", f->gain},           {"gain_sigma", f->gain_sigma}};
        printf("%s\n  {\"image\": ", i ? "," : "");
        cli_print_json_string(scene->frames[i].name);
        printf(", \"edges\": %zu, \"moved\": %s, \"unsettled\": %s", f->edges,
               f->moved ? "true" : "false", f->unsettled ? "true" : "false");
        for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
            printf(", \"%s\": ", numbers[k].name);
            cli_print_json_number(numbers[k].value);
        }
        printf("}");
    }
    puts("]}");
}

static void print_unsettled(const igi_scene *scene, const igi_registered *r)
{
    for (size_t i = 0; i < r->frame_count; i++)
        if (r->frames[i].unsettled)
            printf("image %s: its camera may be off still: it did not settle by its %zu edges; "
                   "leave it out, or give its camera a better start\n",
                   scene->frames[i].name, r->frames[i].edges);
}

static void print_table(const cli_session *s, const igi_scene *scene, const igi_registered *r)
{
    int width = 5;
    for (size_t i = 0; i < r->frame_count; i++) {
        int w = cli_text_width(scene->frames[i].name);
        if (w > width) width = w;
    }
    cli_print_padded("image", width);
    puts("  edges  off px, before   after   moved   sigma    gain");
    for (size_t i = 0; i < r->frame_count; i++) {
        const igi_registered_frame *f = &r->frames[i];
        cli_print_padded(scene->frames[i].name, width);
        if (isnan(f->after_px)) puts("      -  too few edges: left where it was");
        else if (f->moved)
            printf("  %5zu  %14.3f  %6.3f  %6.3f  %6.3f  %6.4f\n", f->edges, f->before_px,
                   f->after_px, f->moved_px, f->sigma_px, f->gain);
        else
            printf("  %5zu  %14.3f  no better place found    %6.4f\n", f->edges, f->before_px,
                   f->gain);
    }
    print_unsettled(scene, r);
    if (r->mesh_is_off)
        puts("edges of different things ask for different cameras: the mesh is off; mend it");
    if (r->world)
        printf("all cameras were off alike: moved together, scale %.5f\n", r->together.scale);
    if (r->lens)
        printf(
            "all photographs share a shift of %+.2f columns and %+.2f rows and a magnification of "
            "%.4f: principal point and focal length were mended\n",
            r->shared.shift_px[0], r->shared.shift_px[1], r->shared.magnification);
    printf("edges off by %.3f px before, %.3f px after; brightness differs by %.2f %% between "
           "photographs\nwritten: %s\n",
           r->before_px, r->after_px, 100 * r->gain_spread, s->values.output);
}

static igi_status run(cli_session *s)
{
    igi_scene *scene = NULL;
    igi_registered *registered = NULL;
    igi_register_options options;
    double rms_m = 0;
    if (!s->values.output) {
        fprintf(stderr, "igi: register: where to? give a file with -o, as SCENE/registered.json\n");
        return IGI_E_USAGE;
    }
    igi_register_options_init(&options);
    options.search_px = s->values.search;
    options.together = s->values.together || s->values.points;
    igi_status status = igi_scene_load(s->context, s->arguments[0], &scene);
    if (status == IGI_OK && s->values.points) status = move_by_points(s, scene, &rms_m);
    if (status == IGI_OK) status = igi_register(s->context, scene, &options, &registered);
    if (status == IGI_OK)
        status = igi_frames_save(s->context, scene->frames, scene->frame_count, s->values.output);
    cli_progress_clear(&s->progress);
    if (status == IGI_OK && s->values.json) print_json(s, scene, registered);
    else if (status == IGI_OK && !s->values.quiet) {
        if (s->values.points) printf("points off by %.4f m\n", rms_m);
        print_table(s, scene, registered);
    }
    igi_registered_destroy(registered);
    igi_scene_destroy(scene);
    return status;
}

const cli_command cli_register = {
    .name = "register",
    .bit = CLI_REGISTER,
    .arguments = 1,
    .usage = "register SCENE -o CAMERAS.json",
    .summary = "cameras refined until photographs and mesh agree",
    .example = "igi register my-room -o my-room/registered.json",
    .details =
        "Moves each camera until the edges in its photograph (between regions, at creases and\n"
        "outlines) lie on those of the mesh. CAMERAS.json is for scene.json's \"cameras\". "
        "Cameras\n"
        "of another frame of reference, as structure from motion gives them, are brought to the\n"
        "mesh's by three or more --points first. Photographs with too few edges stay. Those whose\n"
        "cameras did not settle are named.",
    .run = run,
};
