# SPDX-License-Identifier: MIT
# Templates of gnuplot scripts. A line "#: NAME" begins a template; {0}, {1}, ... are the arguments of fill_template().

#: margins
set lmargin at screen {0:.5f}
set rmargin at screen {1:.5f}
set tmargin at screen {2:.5f}
set bmargin at screen {3:.5f}
#: frameless
unset border
unset tics
set xrange [-1:1]
set yrange [-1:1]
#: map_axis
set {0}range [0:{1}]
set {0}tics {2} nomirror out scale 0.5 font ',9'
#: map
unset colorbox
set border lc rgb '#555555'
set xlabel 'x [cm]' font ',10' offset 0,0.7
set ylabel 'y [cm]' font ',10' offset 1.6,0
#: next_tap
next_x = real(word(${0}[1], 1))
next_y = real(word(${0}[1], 2))
#: surface
set zrange [{0}:{1}]
set ztics 5 font ',9' offset 0.7,0
unset colorbox
set border 31 lc rgb '#777777'
set xyplane at {2}
set xlabel 'x [cm]' font ',10' rotate parallel offset 1.2,-0.3
set ylabel 'y [cm]' font ',10' rotate parallel offset -1.5,-0.3
set zlabel 'height [cm]' font ',10' rotate by 90 offset 3.2,0
set xtics offset -0.3,-0.3
set ytics offset 0.4,-0.3
set view {3}, {4}
set view equal xyz
set pm3d scansautomatic lighting primary 0.35 specular 0
#: colour_bar
unset colorbox
set border lc rgb '#555555'
unset xtics
unset ytics
set xrange [-0.5:1.5]
set yrange [-0.5:{0}]
set y2range [{1}:{2}]
set y2tics nomirror out scale 0.5 font ',9'
#: run_curves
set border 3 lc rgb '#555555'
set tics nomirror out scale 0.5 font ',10'
set grid lc rgb '#e4e4e4' lt 1
set xrange [0:{0}]
set xlabel 'taps' font ',10' offset 0,0.6
{1}set key at graph 0, graph 1.03 left bottom Left reverse horizontal maxcols {2} samplen 1 font ',10'
#: boxes
set border 1 lc rgb '#555555'
set xtics nomirror out scale 0.5 font ',10'
unset ytics
set yrange [{0}:0.4]
set grid x lc rgb '#e4e4e4' lt 1
{1}set style fill transparent solid 0.35 noborder
set xlabel {2} font ',11' offset 0,0.3
#: heat_map
set cbrange [{0:.10g}:{1:.10g}]
unset colorbox
set border lc rgb '#555555'
set xrange [-0.5:{2}]
set yrange [{3}:-0.5]
set xtics {4} {5} scale 0 font ',10'
set ytics {6} scale 0 font ',10'
set label {7} at screen {8:.5f}, screen {9:.5f} center font ',11'
#: group_curves
set border 3 lc rgb '#555555' lw 0.5
set grid y lc rgb '#e4e4e4' lt 1 lw 0.5
#: curves_axis
set {0}range [{1:.6g}:{2:.6g}]
set {0}tics {3:.6g} nomirror out scale 0.5 format '%g'
#: pareto
set title {0} font ',14'
set xlabel {1}
set ylabel {2}
{3}set xrange [{4}:{5}]
set yrange [{6}:{7}]
set lmargin at screen 0.075
set rmargin at screen {8}
set border 3 lc rgb '#555555'
set tics nomirror
set grid lc rgb '#e4e4e4' lt 1
set key at screen {9}, screen 0.93 left top Left reverse samplen 1 spacing 1.3 font ',11'
#: end
