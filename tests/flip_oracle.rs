#![cfg(feature = "flip-oracle")]
mod support;
use support::{pairs, plain_flip::plain_flip};
use volref::compare::flip::{SrgbImage, flip};

fn oracle_flip(reference: &SrgbImage, test: &SrgbImage, ppd: f32) -> Vec<f64> {
    let image = |i: &SrgbImage| {
        nv_flip::FlipImageRgb8::with_data(
            i.width() as u32,
            i.height() as u32,
            i.pixels().as_flattened(),
        )
    };
    nv_flip::flip(image(reference), image(test), ppd)
        .to_vec()
        .into_iter()
        .map(f64::from)
        .collect()
}

#[test]
fn explore() {
    let ppd = volref::compare::flip::DEFAULT_PIXELS_PER_DEGREE as f32;
    for pair in pairs::varied() {
        let o = oracle_flip(&pair.reference, &pair.test, ppd);
        let ours = flip(&pair.reference, &pair.test, f64::from(ppd)).unwrap();
        let p64 = plain_flip::<f64>(&pair.reference, &pair.test, f64::from(ppd));
        let p32 = plain_flip::<f32>(&pair.reference, &pair.test, f64::from(ppd));
        let mut m = [0.0f64; 5];
        let mut worst = 0;
        let mut over = 0;
        for i in 0..o.len() {
            let v = ours.values()[i];
            let d = [
                (v - o[i]).abs(),
                (v - p64[i].error).abs(),
                (o[i] - p32[i].error).abs(),
                (p64[i].colour_distance - p32[i].colour_distance).abs(),
                (p64[i].feature_distance - p32[i].feature_distance).abs(),
            ];
            if d[0] > m[0] {
                worst = i;
            }
            if d[0] > 1e-5 {
                over += 1;
            }
            for j in 0..5 {
                m[j] = m[j].max(d[j]);
            }
        }
        let w = worst;
        println!(
            "{:26} ours-oracle {:.1e} (>1e-5: {over}/{}) ours-plain64 {:.1e} oracle-plain32 {:.1e} | dcol {:.1e} dfeat {:.1e} | worst px: E {:.6} oracle {:.6} col {:.3e}/{:.3e} feat {:.3e}/{:.3e}",
            pair.name,
            m[0],
            o.len(),
            m[1],
            m[2],
            m[3],
            m[4],
            ours.values()[w],
            o[w],
            p64[w].colour_distance,
            p32[w].colour_distance,
            p64[w].feature_distance,
            p32[w].feature_distance
        );
    }
}
