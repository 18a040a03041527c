/* Collides two bodies of a model at poses: `collide MODEL POSES`. Each line of the poses has a place and a quaternion. */
#include <mujoco/mujoco.h>
#include <stdio.h>

/* What is counted. */
__attribute__((noinline)) void narrow_collide(const mjModel *model, mjData *data) { mj_collision(model, data); }

int main(int argc, char **argv) {
    char error[1000] = "";
    if (argc != 3) return 2;
    mjModel *model = mj_loadXML(argv[1], NULL, error, sizeof error);
    FILE *poses = fopen(argv[2], "r");
    if (!model || !poses) {
        fprintf(stderr, "%s\n", error);
        return 1;
    }
    mjData *data = mj_makeData(model);
    double q[7];
    long count = 0, contacts = 0;
    double sum = 0;
    while (fscanf(poses, "%lf %lf %lf %lf %lf %lf %lf", q, q + 1, q + 2, q + 3, q + 4, q + 5, q + 6) == 7) {
        for (int i = 0; i < 7; i++) data->qpos[i] = q[i];
        mj_kinematics(model, data);
        narrow_collide(model, data);
        double least = 1e9;
        for (int i = 0; i < data->ncon; i++)
            if (data->contact[i].dist < least) least = data->contact[i].dist;
        count++;
        contacts += data->ncon;
        if (data->ncon) sum += least;
    }
    printf("%ld %ld %.17g\n", count, contacts, sum);
    mj_deleteData(data);
    mj_deleteModel(model);
    return 0;
}
