// What a motion is shown in.
const MOTION = `<section class="motion" aria-label="Motion">
<svg id="stage" role="img" aria-label="The mechanism; drag, or use the arrow keys with Shift, to look from elsewhere" tabindex="0"></svg>
<div class="controls">
<button id="play" type="button" aria-label="Play"></button>
<button id="before" type="button" aria-label="To the event before">&#x25C2;&#x2758;</button><button id="after" type="button" aria-label="To the next event">&#x2758;&#x25B8;</button>
<span class="line"><input id="time" type="range" min="0" max="1" step="any" value="0" aria-label="Time"><svg id="marks" aria-hidden="true"></svg></span>
<output id="now" for="time"></output>
<label>Speed <select id="speed"></select></label>
<label><input id="names" type="checkbox" checked> names</label>
<label><input id="trails" type="checkbox" checked> paths</label>
<button id="view" type="button">Reset view</button>
</div>
<p class="help">Space plays and pauses; the left and right arrow keys go from moment to moment, comma and point from event to event. Drag the picture to turn it, with Shift or two fingers to move it; pinch, roll, + and - come closer.</p>
<ul class="key" id="key"></ul>
</section>
<div id="zoom"><button id="closer" type="button" aria-label="Show less of the time">+</button><button id="farther" type="button" aria-label="Show more of the time">&minus;</button><button id="whole" type="button">All the time</button><span>zooms the curves in time, as Shift or Ctrl and the wheel do</span></div>
<section id="curves" aria-label="Curves over time"></section>
<section id="events" aria-label="Events"></section>
`;
