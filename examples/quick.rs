use etalon::*;
use std::time::Duration;
struct P;
impl render::Progress for P {
    fn passed(&mut self, d: u32, _w: u32, s: Duration, e: Option<f64>) -> bool {
        eprintln!("{d} {s:?} {e:?}");
        true
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let spp: u32 = a[2].parse().unwrap();
    let mut set = vec![("image.spp".to_string(), a[2].clone())];
    for kv in &a[4..] {
        let (k, v) = kv.split_once('=').unwrap();
        set.push((k.into(), v.into()));
    }
    let scene = match scene::load(
        std::path::Path::new(&a[1]),
        &scene::Overrides { panel: None, set },
    ) {
        Ok(s) => s,
        Err(e) => {
            eprintln!("{e}");
            return;
        }
    };
    let plan = plan::Plan::new(&scene, false).unwrap();
    eprintln!("{:?}", plan.choices);
    let [w, h] = scene.image.size;
    let ins = render::pass::instructions(std::env::var("INS").ok().as_deref()).unwrap();
    let r = render::render(
        &plan,
        &render::Request {
            window: render::tile::Window {
                x0: 0,
                y0: 0,
                x1: w,
                y1: h,
            },
            samples: spp,
            time: None,
            instructions: ins,
        },
        &mut P,
    );
    let n = w as f64 * h as f64 * spp as f64;
    eprintln!(
        "{:.3} s, {:.2} M samples/s  meanY {:?} cut {:?} nan {} rungs {:?}",
        r.seconds,
        n / r.seconds / 1e6,
        r.mean_luminance(),
        r.cut_off(),
        r.not_a_number,
        r.rungs
    );
    let rgb: Vec<[f32; 3]> = r.rgb().iter().map(|e| e.mean.map(|v| v as f32)).collect();
    film::png::write_preview(std::path::Path::new(&a[3]), w as usize, h as usize, &rgb).unwrap();
}
