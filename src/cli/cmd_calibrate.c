/* SPDX-License-Identifier: Apache-2.0
 *
 * igi calibrate: lens and vignetting of a camera.
 */
#include "cli.h"

#include <stdlib.h>
#include <string.h>

static igi_status usage(const char *sentence)
{
    fprintf(stderr, "igi: calibrate: %s\n", sentence);
    return IGI_E_USAGE;
}

static bool read_board(const char *text, igi_chessboard *board)
{
    char *end;
    long columns = strtol(text, &end, 10);
    if (*end != 'x' || columns < 3 || columns > 100) return false;
    long rows = strtol(end + 1, &end, 10);
    if (*end || rows < 3 || rows > 100) return false;
    board->columns = (int)columns;
    board->rows = (int)rows;
    return true;
}

/* What the file already says is kept: vignetting goes into the same file as the lens. */
static igi_status load_present(cli_session *s, igi_calibration **calibration)
{
    FILE *file = fopen(s->values.output, "r");
    if (!file) return IGI_OK;
    fclose(file);
    return igi_calibration_load(s->context, s->values.output, calibration);
}

static igi_status calibrate_overlap(cli_session *s, igi_calibration **calibration)
{
    igi_scene *scene = NULL;
    igi_status status = igi_scene_load(s->context, s->values.overlap, &scene);
    if (status == IGI_OK) status = igi_calibrate_overlap(s->context, scene, calibration);
    igi_scene_destroy(scene);
    return status;
}

static void print_lens(const igi_calibration *c)
{
    int width = 5;
    size_t used = 0;
    for (size_t i = 0; i < c->view_count; i++) {
        int w = cli_text_width(c->views[i].file);
        if (w > width) width = w;
        used += c->views[i].used;
    }
    cli_print_padded("view", width);
    puts("  rms px");
    for (size_t i = 0; i < c->view_count; i++) {
        const igi_calibration_view *view = &c->views[i];
        cli_print_padded(view->file, width);
        if (view->used) printf("  %6.3f\n", view->rms_px);
        else if (view->rms_px > 0)
            printf("  %6.3f  left out: it disagrees with the others\n", view->rms_px);
        else puts("       -  left out: no board in it, or too little");
    }
    printf("fl %.2f %.2f +- %.2f, centre %.2f %.2f +- %.2f, k1 %.4f k2 %.4f k3 %.4f\n",
           c->lens.fl_x, c->lens.fl_y, c->deviations[0], c->lens.cx, c->lens.cy, c->deviations[2],
           c->lens.k1, c->lens.k2, c->lens.k3);
    printf("rms %.4f px over %zu of %zu views\n", c->rms_px, used, c->view_count);
}

static void print_json(const cli_session *s, const igi_calibration *c)
{
    printf("{\"output\": ");
    cli_print_json_string(s->values.output);
    if (c->has_lens) {
        printf(", \"rms_px\": ");
        cli_print_json_number(c->rms_px);
        printf(", \"views\": [");
        for (size_t i = 0; i < c->view_count; i++) {
            printf("%s\n  {\"file\": ", i ? "," : "");
            cli_print_json_string(c->views[i].file);
            printf(", \"rms_px\": ");
            cli_print_json_number(c->views[i].rms_px);
            printf(", \"used\": %s}", c->views[i].used ? "true" : "false");
        }
        printf("]");
    }
    if (c->vignetting.known) {
        printf(", \"vignetting_rms\": ");
        cli_print_json_number(c->vignetting.rms);
    }
    puts("}");
}

static igi_status convert(cli_session *s)
{
    igi_calibration *calibration = NULL;
    if (s->argument_count || s->values.chessboard || s->values.charuco || s->values.flat ||
        s->values.lensfun || s->values.overlap)
        return usage("--convert takes one file; name no images and nothing to calibrate by");
    igi_status status = igi_calibration_import(s->context, s->values.convert, &calibration);
    if (status == IGI_OK)
        status = igi_calibration_export(s->context, calibration, s->values.output);
    igi_calibration_destroy(calibration);
    return status;
}

static igi_status run(cli_session *s)
{
    const cli_values *v = &s->values;
    igi_chessboard board = {.square_m = v->square};
    igi_calibration *calibration = NULL;
    size_t count = (size_t)s->argument_count;
    if (!v->output) return usage("where to? give a file with -o, as calib/NAME.json");
    if (v->convert) return convert(s);
    const char *grid = v->chessboard ? v->chessboard : v->charuco;
    if ((v->chessboard != NULL) + (v->charuco != NULL) + v->flat + v->lensfun +
            (v->overlap != NULL) !=
        1)
        return usage("what do the images show? --chessboard or --charuco COLUMNSxROWS, --flat, "
                     "--overlap SCENE or --lensfun");
    if (v->lensfun && count != 1) return usage("--lensfun takes one photograph, for its EXIF");
    if (!v->overlap != (count > 0))
        return usage(v->overlap ? "--overlap takes the scene's images; name no others"
                                : "name the images");
    if (grid && !read_board(grid, &board))
        return usage("a board is named by its inner corners, 3 to 100 a side, as 9x6");
    if (grid && !(v->square > 0)) return usage("how large are the squares? --square METRES");
    if (grid && v->square > 1) return usage("--square is in metres: 25 mm are .025");
    if (v->charuco && !(v->marker > 0 && v->marker < v->square))
        return usage("how large are the markers? --marker METRES, less than --square");
    if (v->residuals && !grid)
        return usage("--residuals are those of a board's corners; name the board");
    if (v->charuco) board.markers = v->markers, board.marker_m = v->marker;
    igi_status status = load_present(s, &calibration);
    if (status == IGI_OK)
        status = v->overlap ? calibrate_overlap(s, &calibration)
                 : v->lensfun
                     ? igi_calibrate_lensfun(s->context, s->arguments[0], v->lens, &calibration)
                 : v->flat ? igi_calibrate_flat(s->context, s->arguments, count, &calibration)
                           : igi_calibrate_chessboard(s->context, s->arguments, count, &board,
                                                      &calibration);
    if (status == IGI_OK) status = igi_calibration_save(s->context, calibration, v->output);
    if (status == IGI_OK && v->residuals)
        status = igi_calibration_draw_residuals(s->context, calibration, v->residuals);
    cli_progress_clear(&s->progress);
    if (status == IGI_OK && v->json) print_json(s, calibration);
    else if (status == IGI_OK && !v->quiet) {
        const igi_vignetting *g = &calibration->vignetting;
        if (calibration->has_lens && (grid || v->lensfun)) print_lens(calibration);
        if (!grid && g->known)
            printf("V = 1 %+.4f r^2 %+.4f r^4 %+.4f r^6 about %.1f, %.1f; rms %.4f\n", g->k[0],
                   g->k[1], g->k[2], g->centre_x, g->centre_y, g->rms);
    }
    igi_calibration_destroy(calibration);
    return status;
}

const cli_command cli_calibrate = {
    .name = "calibrate",
    .bit = CLI_CALIBRATE,
    .more = true,
    .usage = "calibrate IMAGE... -o CALIB.json",
    .summary = "distortion and vignetting of a camera",
    .example = "igi calibrate --chessboard 9x6 --square .025 board-*.jpg -o calib/lens.json",
    .details =
        "With --chessboard or --charuco: focal lengths, principal point and distortion; views\n"
        "that disagree with the others are left out. With --flat: vignetting, from evenly lit\n"
        "surfaces that fill the frame, into the same file. With --lensfun: both from a database\n"
        "of lenses. With --convert: the lens from and to the files of OpenCV and COLMAP, by\n"
        "their endings.",
    .run = run,
};
