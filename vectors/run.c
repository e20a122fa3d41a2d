/* Holds an implementation to the vectors: cc -o run run.c -lm && ./run FILE.json ... [-m MISTAKE]
   Each entry is a line. Put your own functions in place of these. MISTAKE as in run.py. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST 512
static const double pi = 3.14159265358979323846;
static const char *mistake = "";
static int is(const char *name) { return strcmp(mistake, name) == 0; }

/* Each reads the inputs x, writes its results, and returns how many there are. */
static int composite(const double *x, double *y, int premultiplied) {
    int n = (int)x[0];
    y[0] = y[1] = y[2] = y[3] = 0;
    for (int i = 0; i < n; i++) {
        const double *s = x + 1 + 4 * (is("order") ? n - 1 - i : i);
        double weight = (1 - y[3]) * (premultiplied ? 1 : s[3]);
        for (int c = 0; c < 3; c++) y[c] += weight * s[c];
        y[3] += (1 - y[3]) * s[3];
    }
    return 4;
}
static int straight(const double *x, double *y) { return composite(x, y, 0); }
static int premultiplied(const double *x, double *y) { return composite(x, y, 1); }
static int opacity_over_step(const double *x, double *y) {
    y[0] = x[0] == 1 || is("correction") ? x[0] : -expm1(x[1] / x[2] * log1p(-x[0]));
    return 1;
}
static int trilinear(const double *x, double *y) {
    int n[3] = {(int)x[0], (int)x[1], (int)x[2]}, base[3];
    const double *values = x + 6, *point = values + n[0] * n[1] * n[2];
    double at[3], sum = 0;
    for (int a = 0; a < 3; a++) {
        at[a] = point[a] / x[3 + a] - (is("shifted") ? 0.5 : 0);
        base[a] = (int)fmin(fmax(floor(at[a]), 0), n[a] - 2);
    }
    for (int corner = 0; corner < 8; corner++) {
        int o[3] = {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
        double weight = 1;
        for (int a = 0; a < 3; a++) weight *= o[a] ? at[a] - base[a] : 1 - (at[a] - base[a]);
        sum += weight * values[base[0] + o[0] + n[0] * (base[1] + o[1] + n[1] * (base[2] + o[2]))];
    }
    return y[0] = sum, 1;
}
static int value(const double *x, double *y) {
    double g = is("backward") ? -x[0] : x[0];
    y[0] = (1 - g * g) / (4 * pi * pow(1 + g * g - 2 * g * x[1], 1.5));
    return 1;
}
static int srgb_code(const double *x, double *y) {
    double v = fmin(fmax(x[0], 0), 1);
    double curve = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
    y[0] = floor(255 * (is("gamma") ? pow(v, 1 / 2.2) : curve) + 0.5);
    return 1;
}
static const struct { const char *name; int (*call)(const double *, double *); } functions[] = {
    {"composite", straight}, {"composite_premultiplied", premultiplied}, {"srgb_code", srgb_code},
    {"opacity_over_step", opacity_over_step}, {"trilinear", trilinear}, {"value", value}};

/* The numbers in brackets after the key; how many. */
static int numbers(const char *line, const char *key, double *out) {
    const char *at = strchr(strstr(line, key), '[') + 1;
    int count = 0;
    while (*at != ']' && count < MOST) {
        char *end;
        out[count++] = strtod(at, &end);
        at = end + strspn(end, ", ");
    }
    return count;
}

int main(int argc, char **argv) {
    static char line[1 << 16], name[64];
    double x[MOST], expected[MOST], found[MOST];
    int passed = 0, failed = 0, without = 0;
    if (argc > 2 && strcmp(argv[argc - 2], "-m") == 0) { mistake = argv[argc - 1]; argc -= 2; }
    for (int f = 1; f < argc; f++) {
        FILE *file = fopen(argv[f], "r");
        if (!file) { perror(argv[f]); return 2; }
        while (fgets(line, sizeof line, file)) {
            if (sscanf(line, " {\"function\": \"%63[^\"]", name) != 1) continue;
            int which = 0, known = sizeof functions / sizeof *functions;
            while (which < known && strcmp(functions[which].name, name)) which++;
            if (which == known) { without++; continue; }
            numbers(line, "\"inputs\"", x);
            int count = numbers(line, "\"expected\"", expected);
            double absolute = strtod(strstr(line, "\"absolute\": ") + 12, NULL);
            double relative = strtod(strstr(line, "\"relative\": ") + 12, NULL);
            int right = functions[which].call(x, found) == count;
            for (int i = 0; i < count; i++) right &= fabs(found[i] - expected[i]) <= absolute + relative * fabs(expected[i]);
            if (right) passed++; else failed++;
            if (!right) printf("%s: %s is %.17g, not %.17g\n", argv[f], name, expected[0], found[0]);
        }
        fclose(file);
    }
    printf("%d passed, %d failed, %d of functions that this runner does not have\n", passed, failed, without);
    return failed > 0;
}
